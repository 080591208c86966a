"""Compilation of kernels by numba: each kernel that Python calls becomes one piece of machine code, and no other does.

By default numba makes machine code, a wrapper for Python and one for C of every function, also of those that only
other kernels call, and optimises each of them again inside every caller. That is most of the compile time, and callers
can be optimised less, because their callees must stay callable from outside. Here a kernel has two forms:

- a *part*, which other kernels call: typed and lowered to LLVM's code, and no further;
- an *entry*, which Python calls: all its parts are linked into it as private functions, so that constants and unused
  arguments go through them, and the whole is optimised and made machine code once.

A part is compiled for the types of its arguments and never for the value of a constant argument; LLVM sees to that.
This file alone uses names of numba that are not public. `check` tries all of them; where one has changed,
`sim.jit` compiles kernels in numba's own way.
"""

import contextlib
import functools
import gc
import hashlib
import inspect
import pickle
import sys
import warnings
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any, NamedTuple

import llvmlite.binding as llvm
import numba
import numpy as np
from numba.core import event, serialize, sigutils, types
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, CompileResult, Flags
from numba.core.compiler_lock import global_compiler_lock
from numba.core.environment import lookup_environment
from numba.core.options import TargetOptions
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.runtime.nrt import rtsys
from numba.core.targetconfig import ConfigStack

from sim.files import locked

# njit has no spelling of this flag. Without it each loop starts with run-time overlap checks on every pair of arrays, a
# third of the time at 128 points.
cpu_target.options.noalias = TargetOptions.Mapping("noalias")  # type: ignore[attr-defined]


class Folders(NamedTuple):
    """Folders of the kernels of one source."""

    own: Path | None  # None if none is writable
    shared: tuple[Path, ...]  # only read, if the kernel is not in the writable one


class KernelFile(IndexDataCacheFile):
    """numba's cache file of one kernel in one folder, with a check sum: damaged machine code would end the process.

    numba keeps the kernels of each checkout apart by the path and the time of the source, and those of processors by
    their names. The folder is already named by the code and by the processor, so that checkouts, environments and
    processors share their kernels.
    """

    def load(self, key: Any) -> Any:
        try:
            entry = super().load(key)
            if entry is None:
                return None
            check_sum, data = entry
            return pickle.loads(data) if check_sum == zlib.crc32(data) else None
        except Exception:  # whatever unpickling leads to
            return None

    def has(self, key: Any) -> bool:
        """True if the index lists it as cached."""
        try:
            return key in self._load_index()
        except Exception:  # whatever unpickling leads to
            return False

    def locked(self) -> contextlib.AbstractContextManager[None]:
        """Inside, no other process compiles this kernel."""
        return locked(Path(self._index_path).with_suffix(".lock"))

    def save(self, key: Any, data: Any) -> None:
        data = serialize.dumps(data)
        data = zlib.crc32(data), data
        with contextlib.suppress(OSError):  # a full disk: kept another time
            try:
                super().save(key, data)
            except OSError:
                raise
            except Exception:  # the index is rubbish: an empty one
                self.flush()
                super().save(key, data)


class KernelFiles:
    """The cache files of one kernel, as numba asks them. With a corrupt file or a full disk it compiles again."""

    def __init__(self, folders: Folders, name: str) -> None:
        self.own = KernelFile(str(folders.own), name, "") if folders.own is not None else None
        self.all = [self.own] if self.own is not None else []
        self.all += [KernelFile(str(folder), name, "") for folder in folders.shared]

    def load(self, key: Any) -> Any:
        """Data stored under numba's key, or None."""
        key = without_processor(key)
        return next((data for data in (file.load(key) for file in self.all) if data is not None), None)

    def has(self, key: Any) -> bool:
        """True if an index lists it."""
        key = without_processor(key)
        return any(file.has(key) for file in self.all)

    def locked(self) -> contextlib.AbstractContextManager[None]:
        """Inside, no other process compiles this kernel into the same folder."""
        return self.own.locked() if self.own is not None else contextlib.nullcontext()

    def save(self, key: Any, data: Any) -> None:
        """Save the compiled code, if a folder is writable."""
        if self.own is not None:
            self.own.save(without_processor(key), data)
        else:
            say_nothing_is_kept()


@functools.cache  # once
def say_nothing_is_kept() -> None:
    """Warn that kernels are lost when the program ends."""
    warnings.warn("no folder for kernels is writable: missing kernels are compiled at each start", stacklevel=2)


def without_processor(key: Any) -> tuple[Any, Any]:
    """numba's key of a compiled function: its types and the hash of its code."""
    types_of, _, code = key
    return types_of, code


def file_name(function: Callable[..., Any], options: dict[str, Any]) -> str:
    """Name of a kernel's files: by its name, code, options and the names in it, wherever it stands in its source.

    The folder is named by the sources, which are not always what runs: Python takes byte code for new if the time of
    the source in whole seconds, and its size, are the same.
    """
    used = inspect.getclosurevars(function)
    names = {**used.globals, **used.nonlocals}
    code = contents(function.__code__), [(name, described(names[name])) for name in sorted(names)]
    chosen = [(name, sorted(value) if isinstance(value, set) else value) for name, value in sorted(options.items())]
    digest = hashlib.sha256(repr((code, chosen)).encode()).hexdigest()[:8]
    name = function.__qualname__.replace("<", "").replace(">", "")
    return f"{name}-{digest}.{sys.implementation.cache_tag}"


def described(value: Any) -> Any:
    """The value of a name in a kernel: a kernel's is the name of its files, a number's its text, all else's ""."""
    if isinstance(value, VariantEntry):
        return [described(kernel) for kernel in value.variants.values()]
    if isinstance(value, Entry):
        return value.file_name
    return repr(value) if isinstance(value, bool | int | float | np.number) else ""


def contents(code: CodeType) -> tuple[Any, ...]:
    """The code, names and constants of a function, without strings such as its docstring."""
    constants = [contents(c) if isinstance(c, CodeType) else repr(c) for c in code.co_consts if not isinstance(c, str)]
    return code.co_code, code.co_names, constants


class KernelFlags(Flags):
    """numba's compile options, compared by those that have been set.

    numba looks up each function that a kernel calls, and each `+`, by the options among others, and compares all forty
    of them each time: a third of the time that typing a kernel takes.
    """

    __slots__ = ()

    def __hash__(self) -> int:
        return hash(frozenset(self._values))

    def __eq__(self, other: object) -> bool:
        return self._values == other._values if isinstance(other, KernelFlags) else NotImplemented


@contextlib.contextmanager
def no_strength_reduction() -> Iterator[None]:
    """Without LLVM's last rewriting of loops' addresses: half of the time of making machine code, which runs no faster.

    The option is one of the process, so it is set for our kernels only.
    """
    llvm.set_option("springtide", "-disable-lsr=1")
    try:
        yield
    finally:
        llvm.set_option("springtide", "-disable-lsr=0")


class KernelLibrary(JITCodeLibrary):
    """LLVM code of a part or an entry."""

    _codegen: Any

    def _optimize_functions(self, ll_module: Any) -> None:
        """Optimise each function alone. numba makes a list of passes for each, even for those only declared."""
        ll_module.data_layout = self._codegen._data_layout
        passes, builder = self._codegen._function_pass_manager()
        for function in ll_module.functions:
            if not function.is_declaration:
                passes.run(function, builder)


class PartLibrary(KernelLibrary):
    """LLVM code of a part: neither optimised as a whole nor made machine code."""

    def _optimize_final_module(self) -> None:
        """Left to the entry that it is linked into."""

    def _finalize_final_module(self) -> None:
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        self._ensure_finalized()
        return 0  # no such function

    @property
    def has_dynamic_globals(self) -> bool:
        """True if it holds an address of this process. Before it is optimised it may, without using it.

        An entry that does use one is not cached, so its parts would be compiled again only to be linked into it.
        """
        return False


class EntryLibrary(KernelLibrary):
    """LLVM code of an entry and of all its parts."""

    def _optimize_final_module(self) -> None:
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage == llvm.Linkage.linkonce_odr:
                function.linkage = llvm.Linkage.internal
        super()._optimize_final_module()

    def _finalize_specific(self) -> None:
        """Make machine code, and tell it where the environments of its parts are: the Python objects that they name."""
        with no_strength_reduction():
            super()._finalize_specific()
        for environment in environments(self._final_module):
            self._codegen.set_env(environment.env_name, environment)


class PartCompiler(Compiler):
    """Compiles a part."""

    def compile_extra(self, func: Any) -> Any:
        self.state.flags.no_compile = True
        self.state.library = PartLibrary(self.state.targetctx.codegen(), func.__qualname__)
        return super().compile_extra(func)


class EntryCompiler(Compiler):
    """Compiles an entry."""

    def compile_extra(self, func: Any) -> Any:
        self.state.library = EntryLibrary(self.state.targetctx.codegen(), func.__qualname__)
        self.state.library.enable_object_caching()  # without it, it could not be kept
        return super().compile_extra(func)


class PartResult(CompileResultCacheImpl):
    """The cached form of a part: its LLVM code, and the types that its callers need."""

    def reduce(self, cres: Any) -> Any:
        library, about = cres.library, cres.fndesc
        about.typemap = about.calltypes = None  # large, and not needed to call it
        code = library._get_module_for_linking().as_bitcode()
        used = environments(library._final_module)
        return library.name, code, list(library._reload_init), about, cres.environment, cres.signature, used

    def rebuild(self, target_context: Any, payload: Any) -> Any:
        name, code, reload_init, about, environment, signature, used = payload
        for start in reload_init:  # the threads of a parallel kernel
            start()
        library = PartLibrary(target_context.codegen(), name)
        library._final_module = library._shared_module = llvm.parse_bitcode(code)
        library._finalize_final_module()
        library._reload_init.update(reload_init)
        return CompileResult(
            typing_context=target_context.typing_context,
            target_context=target_context,
            entry_point=None,
            typing_error=None,
            type_annotation="",
            signature=signature,
            objectmode=False,
            lifted=(),
            fndesc=about,
            library=library,
            call_helper=None,
            environment=environment,
            metadata=None,
            reload_init=reload_init,
            referenced_envs=used,  # kept, so that an entry finds them by their names
        )


class EntryResult(CompileResultCacheImpl):
    """The cached form of an entry: its machine code, and the names of its functions.

    numba stores the LLVM code with it, for callers to link, and parses it at each load: 2 to 5 MB of memory for each
    kernel. Callers of ours link the part.
    """

    def reduce(self, cres: Any) -> Any:
        (name, kind, (machine_code, _)), *rest = super().reduce(cres)
        defined = [function.name for function in cres.library._final_module.functions if not function.is_declaration]
        names = llvm.parse_assembly("".join(f'define void @"{one}"() {{ ret void }}\n' for one in defined))
        return (name, kind, (machine_code, names.as_bitcode())), *rest


class KernelCache(FunctionCache):
    """numba's cache of one kernel. Before it loads one, numba imports all that compiling needs: 20 MB and 0.2 s."""

    _impl: Any

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """numba's compile result for a signature, or None."""
        data = self._cache_file.load(self._index_key(sig, target_context.codegen()))
        if data is None:
            return None
        rtsys.initialize(target_context)  # of arrays that kernels allocate
        return self._impl.rebuild(target_context, data)


def environments(module: Any) -> list[Any]:
    """The environments that the code of a module names."""
    names = (variable.name for variable in module.global_variables)
    candidates = (lookup_environment(name) for name in names if name.startswith("_ZN08NumbaEnv"))
    return [environment for environment in candidates if environment is not None]


class Kernel(CPUDispatcher):
    """Base of part and entry: two processes never compile the same kernel into one cache at the same time."""

    _cache: Any
    _compiler: Any

    def while_locked(self, sig: Any, compile: Callable[[Any], Any]) -> Any:
        """`compile` a signature. If it is not cached yet, other processes wait, and load the result.

        Kernels lock their callees while they are locked themselves. No kernel calls its callers, so processes cannot
        deadlock. A process that is killed releases its locks.
        """
        args = tuple(sigutils.normalize_signature(sig)[0])
        file = getattr(self._cache, "_cache_file", None)
        context: Any = self.targetctx
        if args in self.overloads or file is None or file.has(self._cache._index_key(sig, context.codegen())):
            return compile(sig)
        with file.locked():
            return compile(sig)


class Part(Kernel):
    """A kernel as other kernels call it."""

    def compile(self, sig: Any) -> Any:
        """The key of the part for these argument types among numba's functions; made on first use."""
        return self.while_locked(sig, self.load_or_compile)

    def load_or_compile(self, sig: Any) -> Any:
        """`compile`, once others cannot."""
        with global_compiler_lock:
            args, return_type = sigutils.normalize_signature(sig)
            known = self.overloads.get(tuple(args))
            if known is not None:
                return known.entry_point
            result = self._cache.load_overload(sig, self.targetctx)
            if result is None:
                about = {"dispatcher": self, "args": args, "return_type": return_type}
                with event.trigger_event("numba:compile", data=about):
                    result = self._compiler.compile(args, return_type)
                self._cache.save_overload(sig, result)
            # numba looks up callees by entry point; parts have none, so a unique object() is the key.
            result = result._replace(entry_point=object())
            self.targetctx.insert_user_function(result.entry_point, result.fndesc, [result.library])
            self.overloads[tuple(args)] = result
            return result.entry_point


def with_room(call: Callable[[], Any]) -> Any:
    """Call `call` with half a megabyte for the frames of the functions that it calls.

    Python keeps frames in chunks of 16 kB. If a loop calls a function at the end of a chunk, each call maps and unmaps
    the next one: for numba's deep recursion 250,000 times in a race's kernels, a tenth of their compile time. A chunk
    is made as large as the frame that needs it, in powers of two, and this function's frame takes a little over half a
    megabyte.
    """
    return call()


with_room.__code__ = with_room.__code__.replace(co_stacksize=2**16)  # of 8 bytes each


@contextlib.contextmanager
def no_collection() -> Iterator[None]:
    """Without the garbage collector.

    A compiler makes many objects that stay: looking through all of them again and again takes a fifth of the time.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


class Entry(Kernel):
    """A kernel as Python calls it; other kernels are given its part."""

    part: Any
    file_name: str

    def compile(self, sig: Any) -> Any:
        """Called by Python with arguments of new types."""
        compile = super().compile
        with no_collection():
            return with_room(lambda: self.while_locked(sig, compile))

    def compile_part(self, args: tuple[Any, ...]) -> Any:
        """The type of the result for arguments of these types; the part is made on first use."""
        with no_collection():
            template = with_room(lambda: self.get_call_template(args, {}))
        return self.part.overloads[tuple(template[2])].signature.return_type

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """numba asks for this as it types a call: constants count as any other value of their type.

        Raises TypeError if the caller would release an array that this kernel returns without having counted it.
        """
        template = self.part.get_call_template([types.unliteral(a) for a in args], kws)
        caller = ConfigStack.top_or_none()
        if caller is not None and caller.nrt and not self.targetoptions["_nrt"]:
            result = self.part.overloads[tuple(template[2])].signature.return_type
            if self.targetctx.data_model_manager[result].contains_nrt_meminfo():
                raise TypeError(f"{self.__name__} returns an array: a kernel that calls it needs allocates=False")
        return template

    def get_overload(self, sig: Any) -> Any:
        """numba asks for this as it lowers a call."""
        return self.part.get_overload(sig)


class VariantEntry(Entry):
    """One of several kernels, by the class of a record (a NamedTuple) among the arguments."""

    variants: dict[Any, Any]

    def variant(self, args: Any) -> Any:
        """The kernel for these argument types. Raises TypeError if none fits."""
        for arg in args:
            kernel = self.variants.get(getattr(arg, "instance_class", None))
            if kernel is not None:
                return kernel
        raise TypeError(f"{self.__name__}: no kernel for arguments of types {', '.join(map(str, args))}")

    def get_call_template(self, args: Any, kws: Any) -> Any:
        return self.variant(args).get_call_template(args, kws)

    def get_overload(self, sig: Any) -> Any:
        return self.variant(sig).get_overload(sig)

    def compile_part(self, args: tuple[Any, ...]) -> Any:
        return self.variant(args).compile_part(args)

    def compile(self, sig: Any) -> Any:
        """Called from Python with arguments of new types; the next call finds the kernel without it."""
        args = tuple(sigutils.normalize_signature(sig)[0])
        kernel = self.variant(args)
        entry_point = kernel.compile(sig)
        if args not in self.overloads:
            self.add_overload(kernel.overloads[args])
        return entry_point


def make_kernel(
    function: Callable[..., Any], folders: Folders | None, options: dict[str, Any], *, noalias: bool, counts: bool
) -> Entry:
    """numba's function of a kernel with njit's `options`, kept in `folders` while numba's cache folder is writable.

    noalias, counts: whether arrays that are written overlap no other, and whether array arguments are counted.
    """
    options = {**options, "_nrt": counts, "no_cfunc_wrapper": True, **({"noalias": True} if noalias else {})}
    name = file_name(function, options)
    entry = compiled(function, folders, name, EntryCompiler, EntryResult, options)
    options["no_cpython_wrapper"] = True
    part = compiled(function, folders, f"{name}-part", PartCompiler, PartResult, options)
    entry.__class__, part.__class__ = Entry, Part
    entry.part, entry.file_name = part, name
    return entry


def compiled(
    function: Callable[..., Any],
    folders: Folders | None,
    name: str,
    pipeline: type,
    result: type,
    options: dict[str, Any],
) -> Any:
    """numba's function of one form of a kernel, kept in `folders`, in files of this name, as `result` says."""
    made = numba.njit(cache=folders is not None, pipeline_class=pipeline, **options)(function)
    made._compiler._customize_flags = KernelFlags  # type: ignore[attr-defined]
    if folders is not None:
        cache = made._cache  # type: ignore[attr-defined]
        cache.__class__ = KernelCache
        cache._cache_file = KernelFiles(folders, name)
        cache._impl.__class__ = result
    return made


def choose(variants: dict[type, Any]) -> VariantEntry:
    """A kernel that stands for one of `variants`, by the class of a record (a NamedTuple) among its arguments."""
    made: Any = numba.njit(next(iter(variants.values())).py_func)
    made.__class__ = VariantEntry
    made.variants = variants
    return made


class Pair(NamedTuple):
    """A record that `check` hands to kernels."""

    x: float
    y: float


def added(pair: Any) -> Any:
    return pair.x + pair.y


def stored(pair: Any) -> Any:
    total = np.empty(1)
    total[0] = added(pair)
    return total[0]


def doubled(pair: Any) -> Any:
    return added(pair) + added(pair)


def check(folder: Path) -> None:
    """Compile kernels, keep them in `folder`, numba's cache folder just now, and load them again.

    Raises whatever a part of numba that has changed leads to.
    """
    pair, folders = Pair(1.0, 2.0), Folders(folder, ())
    for caller, expected in ((stored, 3.0), (doubled, 6.0), (stored, 3.0)):
        file_count = len(list(folder.glob(f"*{caller.__name__}*.nbc")))  # none on a full disk
        callee = make_kernel(added, folders, {"nogil": True}, noalias=True, counts=False)
        function = FunctionType(caller.__code__, {**globals(), "added": choose({Pair: callee})})
        entry = make_kernel(function, folders, {"nogil": True}, noalias=False, counts=True)
        values = callee(pair), entry(pair), sum(entry.stats.cache_hits.values())
        if values != (3.0, expected, file_count):
            raise RuntimeError(f"kernels give {values} instead of {(3.0, expected, file_count)}")

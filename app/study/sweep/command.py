"""`springtide sweep`: check everything, run the missing cases, and write the results."""

import argparse
import contextlib
import importlib.util
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import Any

from app.files import check_out_file
from app.formats.text_tables import say
from app.study.pool import progress_bar
from app.study.sweep.case import DIVERGED, ENDS, FAILED, Outcome
from app.study.sweep.spec import Spec, read_spec
from sim.files import draft_of, replacing
from sim.validation import argument_error

REQUIRED_PACKAGES = ("xarray", "netCDF4")
FIGURE_SUFFIXES = (".png", ".svg")

Outcomes = Generator[tuple[int, Outcome], None, None]  # number and outcome of each finished case
Run = Callable[[dict[int, Any]], Outcomes]  # takes jobs by number


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    parser.add_argument("spec", type=Path, metavar="SPEC.toml", help="what to sweep; for examples see assets/sweeps")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.nc")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="run on a Dask cluster instead of this machine's cores")
    parser.add_argument("--fresh", action="store_true", help="start over, and replace earlier results")


def run(arguments: argparse.Namespace) -> int:
    """Run the sweep; returns the exit status."""
    return sweep(arguments.spec, arguments.out, arguments.scheduler, fresh=arguments.fresh)


def sweep(spec_path: Path, out: Path, scheduler: str | None = None, *, fresh: bool = False) -> int:
    """Run the sweep that a spec describes and write `out`; returns 0, or 1 where cases failed.

    Raises ValueError for an invalid spec, before any work and before any file is made or removed; OSError for later
    failures.
    """
    spec = read_spec(spec_path)
    for line in spec.notes:
        say(line)
    figures = [draft_of(out.with_suffix(suffix)).name for suffix in FIGURE_SUFFIXES]
    check_out_file("--out", out, f"{out.name}.cases-journal", *figures, endings=(".nc",))
    for package in (*REQUIRED_PACKAGES, *(("distributed",) if scheduler is not None else ())):
        if importlib.util.find_spec(package) is None:
            raise ValueError(f"sweep: {package} is not installed (pip install '.[sweep]')")
    from app.study.sweep.results import identity, identity_in, to_dataset, write
    from app.study.sweep.store import Store, check_same_sweep, remove

    stored = out.with_name(f"{out.name}.cases")
    if not fresh and out.exists() and not stored.exists():
        before = identity_in(out)
        if before is None:
            raise argument_error("--out", str(out), "a new name, or --fresh to replace the file")
        check_same_sweep(out, before, identity(spec))
        say(f"all {len(spec.cases)} cases are finished; --fresh runs them again", out)
        return 0
    with contextlib.ExitStack() as stack:
        run = stack.enter_context(runner(spec, scheduler))
        if fresh:
            remove(stored)
        store = stack.enter_context(contextlib.closing(Store(stored, identity(spec))))
        outcomes = run_missing(spec, store, run)
        dataset = to_dataset(spec, outcomes)
        write(dataset, out)
        figures = write_figures(dataset, out)
        store.remove()
    report(out, figures, dataset, outcomes)
    return 1 if any(outcome.end == FAILED for outcome in outcomes.values()) else 0


@contextlib.contextmanager
def runner(spec: Spec, scheduler: str | None) -> Iterator[Run]:
    """The function that runs jobs: on the cluster with this scheduler, or on all cores of this machine."""
    from app.study.sweep import workers

    if scheduler is not None:
        with workers.connected(scheduler) as client:
            yield lambda jobs: workers.on_cluster(client, jobs)
        return
    from app.scenes.ahead.compiling import prepare

    def run(jobs: dict[int, Any]) -> Outcomes:
        prepare(spec.scene, drawn=False)  # compiled once here instead of in every worker
        yield from workers.on_cores(jobs)

    yield run


def run_missing(spec: Spec, store: Any, run: Run) -> dict[int, Outcome]:
    """Run and store the missing cases; returns the outcomes of all."""
    outcomes: dict[int, Outcome] = store.outcomes
    total = len(spec.cases)
    jobs = {
        number: (spec.scene, {**spec.fixed, **values}, spec.times)
        for number, values in enumerate(spec.cases)
        if number not in outcomes
    }
    if outcomes:
        print(f"{len(outcomes)} of {total} cases were finished before")
    if not jobs:
        return outcomes
    try:
        with counting_bar(spec.scene, total, len(outcomes)) as advance, contextlib.closing(run(jobs)) as results:
            for number, outcome in results:
                store.add(number, outcome)
                outcomes[number] = outcome
                advance(outcome)
    except KeyboardInterrupt:
        say(f"stopped; {len(outcomes)} of {total} cases are kept; the same command resumes", store.path)
        raise
    return outcomes


@contextlib.contextmanager
def counting_bar(name: str, total: int, done: int) -> Iterator[Callable[[Outcome], None]]:
    """A progress bar of cases; yields the function to call with each outcome."""
    counts: dict[str, int] = dict.fromkeys(ENDS, 0)
    with progress_bar() as progress:
        task = progress.add_task(name, total=total, completed=done)

        def advance(outcome: Outcome) -> None:
            counts[outcome.end] += 1
            more = "".join(f", {counts[end]} {end}" for end in (DIVERGED, FAILED) if counts[end])
            progress.update(task, advance=1, description=f"{name}{more}")

        yield advance


def write_figures(dataset: Any, out: Path) -> list[Path]:
    """Write the figure beside the results, as PNG and as SVG; returns their paths, none without matplotlib."""
    from app.study.sweep.figure import draw

    try:
        figure = draw(dataset)
    except ModuleNotFoundError as missing:
        print(f"no figure: {missing.name} is not installed (pip install '.[plot]')")
        return []
    paths = [out.with_suffix(suffix) for suffix in FIGURE_SUFFIXES]
    for path in paths:
        with replacing(path) as draft:
            figure.savefig(draft, dpi=150)
    return paths


def report(out: Path, figures: list[Path], dataset: Any, outcomes: dict[int, Outcome]) -> None:
    """Print the written file, and the error of the first failed case."""
    ends = [outcome.end for outcome in outcomes.values()]
    counted = ", ".join(f"{ends.count(end)} {end}" for end in ENDS if end in ends)
    sizes = ", ".join(f"{name} {size}" for name, size in dataset.sizes.items())
    say(f"{len(ends)} cases ({counted}) over {sizes}" + "".join(f", {path.name}" for path in figures), out)
    first = next((outcome.message for outcome in outcomes.values() if outcome.end == FAILED), "")
    if first:
        say(f"The first that failed: {first}")

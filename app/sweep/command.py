"""`springtide sweep`: check everything, run what is not finished yet, write the results whole."""

import contextlib
import importlib.util
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from app.files import check_out_file
from app.sweep.case import DIVERGED, ENDS, FAILED, Outcome
from app.sweep.spec import Spec, read_spec
from sim.files import replacing
from sim.validation import argument_error

NEEDED = ("xarray", "netCDF4", "matplotlib")


def sweep(spec_path: Path, out: Path, scheduler: str | None = None, *, fresh: bool = False) -> int:
    """Run the sweep that a spec describes into `out`; returns 0, or 1 where cases failed.

    Raises ValueError for what is not allowed, before any work; OSError for what goes wrong on the way.
    """
    spec = read_spec(spec_path)
    if out.suffix != ".nc":
        raise argument_error("--out", str(out), "a name that ends in .nc")
    check_out_file("--out", out, f"{out.name}.cases-journal")
    for package in (*NEEDED, *(("distributed",) if scheduler else ())):
        if importlib.util.find_spec(package) is None:
            raise ValueError(f"sweep: {package} is not installed (pip install 'springtide[sweep]')")
    from app.sweep.results import identity, identity_in, to_dataset, write
    from app.sweep.store import Store, refuse_other, remove

    kept = out.with_name(f"{out.name}.cases")
    if fresh:
        remove(kept)
    elif out.exists() and not kept.exists():
        before = identity_in(out)
        if before is None:
            raise argument_error("--out", str(out), "a new name, or --fresh to replace what is there")
        refuse_other(out, before, identity(spec))
        print(f"{out}: all {len(spec.cases)} cases are there; --fresh runs them again")
        return 0
    store = Store(kept, identity(spec))
    with contextlib.closing(store):
        outcomes = run_missing(spec, store, scheduler)
        dataset = to_dataset(spec, outcomes)
        write(dataset, out)
        figures = write_figures(dataset, out)
        store.remove()
    report(out, figures, dataset, outcomes)
    return 1 if any(outcome.end == FAILED for outcome in outcomes.values()) else 0


def run_missing(spec: Spec, store: Any, scheduler: str | None) -> dict[int, Outcome]:
    """Run and keep what is not kept yet; returns every case's outcome."""
    outcomes = store.cases()
    total = len(spec.cases)
    jobs = {
        number: (spec.scene, {**spec.fixed, **values}, spec.times)
        for number, values in enumerate(spec.cases)
        if number not in outcomes
    }
    if outcomes:
        print(f"{len(outcomes)} of {total} cases are kept from before")
    try:
        with progress_bar(spec.scene, total, len(outcomes)) as advance:
            if not jobs:
                return outcomes
            with contextlib.closing(runner(spec, jobs, scheduler)) as results:
                for number, outcome in results:
                    store.add(number, outcome)
                    outcomes[number] = outcome
                    advance(outcome)
    except KeyboardInterrupt:
        print(f"stopped: {len(outcomes)} of {total} cases are kept in {store.path}; the same command goes on")
        raise
    return outcomes


def runner(spec: Spec, jobs: dict[int, Any], scheduler: str | None) -> Any:
    """The generator of outcomes."""
    from app.sweep.workers import on_cluster, on_cores

    if scheduler is not None:
        return on_cluster(scheduler, jobs)
    from app.scenes.warmup import prepare

    # Once here rather than once in each worker.
    prepare(spec.scene, drawn=False)
    return on_cores(jobs)


@contextlib.contextmanager
def progress_bar(name: str, total: int, done: int) -> Iterator[Any]:
    """A bar of cases; yields what is to be called with each outcome."""
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    counts: dict[str, int] = dict.fromkeys(ENDS, 0)
    with Progress(*columns, transient=True) as progress:
        task = progress.add_task(name, total=total, completed=done)

        def advance(outcome: Outcome) -> None:
            counts[outcome.end] += 1
            more = "".join(f", {counts[end]} {end}" for end in (DIVERGED, FAILED) if counts[end])
            progress.update(task, advance=1, description=f"{name}{more}")

        yield advance


def write_figures(dataset: Any, out: Path) -> list[Path]:
    """The figure beside the results, as PNG and as SVG."""
    from app.sweep.figure import draw

    figure = draw(dataset)
    paths = [out.with_suffix(suffix) for suffix in (".png", ".svg")]
    for path in paths:
        with replacing(path) as draft:
            figure.savefig(draft, dpi=150)
    return paths


def report(out: Path, figures: list[Path], dataset: Any, outcomes: dict[int, Outcome]) -> None:
    ends = [outcome.end for outcome in outcomes.values()]
    counted = ", ".join(f"{ends.count(end)} {end}" for end in ENDS if end in ends)
    sizes = ", ".join(f"{name} {size}" for name, size in dataset.sizes.items())
    print(f"{out}: {len(ends)} cases ({counted}) over {sizes}; {', '.join(path.name for path in figures)}")
    first = next((outcome.message for outcome in outcomes.values() if outcome.end == FAILED), "")
    if first:
        print(f"The first that failed: {first}")

"""The runs of a scene: which commands begin another one, and the undo that goes back to one that was left."""

from app.messages import BaseParams, KeptState, Pause, Take
from app.server.activity import OTHER_FORCES
from app.server.left_runs import LeftRun, LeftRuns
from app.server.run import SceneRun
from app.server.snapshots import kept_state
from sim.parameters import effect_of_change


class Runs:
    """Lets the runs of a scene follow each other, with the parameters that come."""

    def __init__(self, run: SceneRun) -> None:
        self.run = run
        self.number, self.left = 1, LeftRuns()  # of this run; those before it

    def obey(self, command: Take) -> None:
        """Take a record of parameters: with another run, or according to the effect of the change."""
        params, start, state, number, back = command
        if not command.changes_only:
            self.run.awaited = None
        if back:
            self.go_back(params, number)
            return
        if not command.changes_only or effect_of_change(self.run.scene.params, params) == "start":
            self.leave_for(number)
        if start:
            self.begin_with(params)
        elif state is not None:
            self.resume(params, state)
        else:
            self.take(params)

    def take(self, params: BaseParams) -> None:
        """Take parameters according to the effect of their change."""
        run, scene = self.run, self.run.scene
        effect = effect_of_change(scene.params, params)
        if effect in (None, "look"):
            scene.params = params
            return
        run.pacer.cost_unknown = True
        if run.replay is not None:
            run.halt(run.replay.reason)
            run.replay = None
        if effect == "forces" and not run.unmade:
            run.guarded(lambda: scene.change_forces(params), OTHER_FORCES)
            scene.params = params  # also where the scene failed, so that a reset has them
        else:
            scene.params = params
            if run.seat is not None:
                run.seat.begin_others()
            run.reset()

    def begin_again(self, number: int) -> None:
        """The scene from its start, as the run of that number; 0: as this one."""
        self.run.awaited = None
        self.leave_for(number)
        self.run.counts["starts"] += 1
        self.run.reset()

    def begin_with(self, params: BaseParams, left: LeftRun | None = None) -> None:
        """The scene from its start with these parameters, running; or as it was in a run that was left."""
        run = self.run
        run.scene.params, run.pacer.cost_unknown = params, True
        run.counts["starts"] += 1
        run.reset(None if left is None else lambda: self.return_to(left))
        run.running = not run.halted

    def resume(self, params: BaseParams, state: KeptState) -> None:
        """The scene from a state that was kept, with the parameters that it had then, running."""
        run = self.run
        run.clear()
        run.scene.params, run.pacer.cost_unknown = params, True
        run.snapshots.forget_rates()
        run.guarded(lambda: run.scene.resume(state.value))
        if run.seat is not None:
            run.seat.go_on_from(run.scene.time)
        run.running = not run.halted

    def leave_for(self, number: int) -> None:
        """Keep the present run for an undo before the run of that number begins, unless it has halted."""
        run = self.run
        if number in (0, self.number):
            return
        if not (run.stopped_by or run.unmade or run.unfinished):
            state = kept_state(run.scene)
            self.left.add(LeftRun(self.number, state, tuple(run.snapshots.kept_rows), run.running))
        self.number = number

    def go_back(self, params: BaseParams, number: int) -> None:
        """Go back to the run of that number, as it was when it was left; from its start if it is not kept."""
        if number == self.number:  # the one that would have followed has not begun
            self.take(params)
            return
        run, left = self.run, self.left.pop(number)
        self.number = number
        self.begin_with(params, left)
        if left is None:
            run.snapshots.show_restarted()
            return
        run.running = left.running and not run.halted
        if run.seat is not None and not run.running:
            run.seat.tell_others(Pause())

    def return_to(self, left: LeftRun) -> None:
        """The scene from its start, then as it was in a run that was left, with its plots."""
        run = self.run
        run.scene.reset()
        run.snapshots.bring_back(left.rows)
        run.scene.resume(left.state.value)
        if run.seat is not None:
            run.seat.go_on_from(run.scene.time)

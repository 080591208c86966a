"""A student's saved functions while a lab runs: versions, and the scenes that use them.

The path of a saved `rope.py` to the moving rope:

1. The thread of `session.py` looks at the folder twice a second.
2. `versions.py` finds the save and copies it (`saved.py`); `source.py` names the functions with a body.
3. `live_net.py` tries it in a few steps; `versions.py` lets it take over and names the process.
4. `app/lab/process`: `runner.py` sends the steps to the process (`template.py` forks it, `wire.py` packs them);
   `worker.py` and `rope_march.py` take them with the student's functions.
5. `app/scenes/rope/student_rope.py` and `app/scenes/springs/student_net.py` ask for the steps of each piece of the
   program's motion, and `app/scenes/rope/scene.py` puts both ropes into its frame.
"""

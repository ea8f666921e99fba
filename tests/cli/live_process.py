#!/usr/bin/env python3
"""`pellicle live` as a process: the first SIGINT or SIGTERM ends it whatever it does, a command is answered within a second whatever the
simulation does, and a killed session is there again at the next start, with the same bits.

usage: live_process.py PROGRAM
"""
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from live_page import Page, Program

BALL = """version: 1
title: a ball
bodies:
  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 4 }, mass: { per_vertex: 0.1 },
      springs: { stiffness: 3, damping: 0.1 }, volumetric: { stiffness: 1.5, damping: 0.1 } }
solver: { method: quasi-static, dt: 0.01 }
duration: 1
"""
# a step of minutes; a scene that opens for minutes
SLOW = """version: 1
bodies: [{ mesh: { shape: geodesic-sphere, frequency: 20 }, mass: { density: 1000 }, membrane: { preset: rubber, thickness: 0.001 } }]
solver: { method: xpbd, substeps: 1000000 }
duration: 1
"""
HUGE = """version: 1
bodies: [{ mesh: { shape: geodesic-sphere, frequency: 300 }, mass: { density: 1000 }, membrane: { preset: rubber, thickness: 0.001 } }]
solver: { method: static }
contact: { self: true }
duration: 1
"""
# s; docs/live.md promises a second, and the machine may be busy
SOON = 1.0
failures = []


def check(condition, what):
    print("ok    " if condition else "FAILED", what, flush=True)
    if not condition:
        failures.append(what)


def check_signal(program, folder, what, number, *lines, wait=0.5):
    """the signal while the lines are carried out"""
    server = Program(program, folder, "ball.yaml", "--paused")
    page = Page(server)
    for line in lines:
        page.say(line)
    time.sleep(wait)
    status, took, text = server.end(number)
    check(status == 0 and took < SOON and text.strip() == "", f"{what}: ends with {status} after {took:.2f} s {text.strip()}")
    page.close()


def signals(program, folder):
    for number in (signal.SIGINT, signal.SIGTERM):
        check_signal(program, folder, f"{number.name} at rest", number, wait=0.1)
        check_signal(program, folder, f"{number.name} while it plays", number, "play")
        check_signal(program, folder, f"{number.name} in a step of minutes", number, f"open {SLOW}", "step", wait=1)
        check_signal(program, folder, f"{number.name} while a huge scene opens", number, f"open {HUGE}", wait=1)


def answers(program, folder):
    """the slowest of some answers; a stage that takes long is stopped by what undoes it"""
    server = Program(program, folder, "ball.yaml", "--fresh", "-q")
    page = Page(server)
    slowest = max(page.answer("mark", "grab 0 -5 0 0 1 0 20 0.3", f"move 0 {-1 - i / 100} 0", "release")[1] for i in range(30))
    check(slowest < SOON, f"the slowest of 30 answers takes {slowest:.3f} s")
    page.say(f"open {HUGE}")
    time.sleep(1)
    took = page.answer("pause")[1]
    check(took < SOON, f"an answer while a huge scene opens takes {took:.2f} s")
    page.answer(f"open {SLOW}")
    page.say("step")
    time.sleep(1)
    frame, took = page.answer("pause")
    check(took < SOON and frame["step"] == 0, f"an answer in a step of minutes takes {took:.2f} s")
    server.end(signal.SIGKILL)
    page.close()


def crashes(program, folder):
    """what was done up to a second before SIGKILL is there again"""
    server = Program(program, folder, "ball.yaml", "--fresh", "--paused", "-q")
    page = Page(server)
    page.answer("mark", "grab 0 -5 0 0 1 0 20 0.3", "move 0 -1.5 0", *["step"] * 10, "release", "set bodies.ball.springs.stiffness 4", *["step"] * 5)
    before = page.answer("pause")[0]
    time.sleep(1.5)
    server.end(signal.SIGKILL)
    page.close()
    kept = list((folder / "state/pellicle").glob("live-*.yaml"))
    check(len(kept) == 1 and kept[0].stat().st_mode & 0o777 <= 0o644, f"one kept state: {[path.name for path in kept]}")
    check((folder / "state/pellicle").stat().st_mode & 0o777 == 0o700, "only this user sees the folder of states")
    # the next start, and one beside it
    server = Program(program, folder, "ball.yaml", "--paused")
    beside = Program(program, folder, "ball.yaml", "--paused")
    page = Page(server)
    while page.answer()[0]["step"] < before["step"]:
        time.sleep(0.1)
    after = page.answer("pause")[0]
    check(after["hash"] == before["hash"] and after["step"] == 15, f"the next start has step {after['step']}, {after['hash']}")
    check("repeats the last session: 4 commands, 15 steps" in server.end(signal.SIGTERM)[2], "and says what it repeats")
    text = beside.end(signal.SIGTERM)[2]
    check("another 'pellicle live' keeps the session" in text and "repeats" not in text, "a second one beside it starts anew")
    page.close()
    # as it is a scene, `run` repeats it too; --fresh forgets it
    server = Program(program, folder, "ball.yaml", "--fresh", "--paused")
    page = Page(server)
    check(page.answer("pause")[0]["step"] == 0, "--fresh starts at step 0")
    server.end(signal.SIGTERM)
    page.close()
    check(not list((folder / "state/pellicle").glob("live-*.yaml")), "and nothing is kept where nothing was done")


def main():
    program = str(Path(sys.argv[1]).resolve())
    folder = Path(tempfile.mkdtemp(prefix="pellicle-live-"))
    (folder / "ball.yaml").write_text(BALL)
    try:
        for part in (signals, answers, crashes):
            part(program, folder)
    finally:
        shutil.rmtree(folder)
    print(f"{len(failures)} failures")
    sys.exit(1 if failures else 0)


main()

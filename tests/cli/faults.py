#!/usr/bin/env python3
"""What goes wrong around a run: it is killed, hung up, out of disk, memory or permissions, or not alone. Whatever happens,
the message names the cause, the files in the folder are whole, and the run can go on to the same end.

usage: faults.py PROGRAM
"""
import json
import os
import pathlib
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
import xml.dom.minidom

SCENE = """version: 1
bodies: [{ name: ball, mesh: { shape: geodesic-sphere, frequency: 5 }, springs: { stiffness: 3 } }]
loads: [{ body: ball, force: [0, 0, -1], at: { nearest: [0, 0, 1] } }]
solver: { alpha: 50, dt: 0.01 }
duration: 20
output: { every: 0.2, checkpoint: 1 }
"""


# 40 s of one step: modes
LONG = """version: 1
bodies:
  - name: shell
    mesh: { shape: geodesic-sphere, frequency: %d, radius: 0.1 }
    mass: { density: 1000, thickness: 0.002 }
    membrane: { material: neo-hookean, young: 1.0e5, poisson: 0.3, thickness: 0.002 }
    bending: { model: midedge }
    pinned: { box: { min: [-1, -1, -1], max: [1, 1, -0.09] } }
solver: { method: static, analysis: modal, modes: 60, dt: 1 }
"""

JAM = """version: 1
bodies:
  - name: ball
    mesh: { shape: geodesic-sphere, frequency: %d, radius: 0.1 }
    mass: { density: 1000, thickness: 0.002 }
    membrane: { material: neo-hookean, young: 1.0e5, poisson: 0.3, thickness: 0.002 }
tools:
  - { name: upper, shape: box, size: [0.3, 0.3, 0.1], motion: [ { position: [0, 0, 0.151] }, { time: 0.05, position: [0, 0, 0.051] } ] }
  - { name: lower, shape: box, size: [0.3, 0.3, 0.1], motion: [ { position: [0, 0, -0.151] }, { time: 0.05, position: [0, 0, -0.051] } ] }
contact: { self: true, friction: 0.5 }
solver: { method: METHOD, dt: 0.05 }
duration: 1
"""

# rigid balls under a plate, whose pairs do not fit into the memory in the middle of a step
PILE = """version: 1
bodies:
%s
tools:
  - { name: floor, shape: box, size: [3, 3, 0.1], motion: [{ position: [0, 0, -0.05] }] }
  - { name: plate, shape: box, size: [3, 3, 0.1], motion: [{ position: [0, 0, 0.36] }, { time: 0.1, position: [0, 0, 0.25] }] }
gravity: [0, 0, -9.81]
contact: { memory_limit: 1.0e6 }
solver: { dt: 0.1 }
duration: 0.1
"""


class Faults:
    def __init__(self, program, folder):
        self.program, self.folder = program, pathlib.Path(folder)
        (self.folder / "scene.yaml").write_text(SCENE)

    def start(self, *arguments, limits=None):
        def prepare():
            for kind, value in (limits or {}).items():
                resource.setrlimit(kind, (value, value))
        return subprocess.Popen([self.program, *map(str, arguments)], cwd=self.folder, text=True, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=prepare)

    def run(self, *arguments, **options):
        process = self.start(*arguments, **options)
        output, errors = process.communicate(timeout=300)
        return process.returncode, output, errors

    def summary(self, run):
        return json.loads((self.folder / run / "summary.json").read_text())

    def check_whole(self, run, left_over=0):
        """every file of the folder stands under its name as a whole

        left_over: files under a temporary name that may be there. Between a whole file's getting a name and its taking the
        place of an older one a kill leaves one such name; the next run into the folder removes it.
        """
        path = self.folder / run
        left = [entry.name for entry in path.rglob(".pellicle-*.tmp") if "reserve" not in entry.name]
        frames = sorted((path / "frames").glob("*.vtp")) if (path / "frames").exists() else []
        for frame in frames:
            content = frame.read_bytes()
            assert content.startswith(b"<?xml") and content.rstrip().endswith(b"</VTKFile>"), frame
        if (path / "frames.pvd").exists():
            document = xml.dom.minidom.parse(str(path / "frames.pvd"))
            for entry in document.getElementsByTagName("DataSet"):
                assert (path / entry.getAttribute("file")).exists(), entry.getAttribute("file")
        if (path / "summary.json").exists():
            self.summary(run)
        assert len(left) <= left_over or not hasattr(os, "O_TMPFILE"), left

    def wait_for(self, path, process, seconds=300):
        end = time.monotonic() + seconds
        while not (self.folder / path).exists():
            assert process.poll() is None and time.monotonic() < end, f"{path} does not appear"
            time.sleep(0.01)


def killed(f):
    """kill -9 at random moments, then on from the checkpoint, to the same end"""
    f.run("run", "scene.yaml", "-q", "-o", "whole")
    wanted = f.summary("whole")["state_hash"]
    chance, resumed = random.Random(4), 0
    for number in range(6):
        name = f"killed{number}"
        process = f.start("run", "scene.yaml", "-q", "-o", name)
        f.wait_for(f"{name}/frames", process)
        time.sleep(chance.uniform(0, 0.3))
        process.kill()
        process.communicate()
        f.check_whole(name, left_over=1)
        checkpoint = f.folder / name / "checkpoint"
        rest = ["--resume", f"{name}/checkpoint"] if checkpoint.exists() else []
        status, _, errors = f.run("run", "scene.yaml", "-q", "-o", name, *rest)
        assert status == 0, errors
        assert f.summary(name)["state_hash"] == wanted
        f.check_whole(name)
        resumed += len(rest) > 0
    return f"{resumed} of 6 went on"


def stopped(f):
    """SIGHUP, SIGTERM and SIGINT: status 1, a message, a checkpoint to go on from"""
    for number in (signal.SIGHUP, signal.SIGTERM, signal.SIGINT):
        name = f"stopped{number}"
        process = f.start("run", "scene.yaml", "-o", name, "--set", "duration=100000", "--progress", "plain")
        f.wait_for(f"{name}/frames/f00001.vtp", process)
        process.send_signal(number)
        output, errors = process.communicate(timeout=300)
        assert process.returncode == 1 and "stopped at step" in errors, (number, errors)
        assert "stopping; the same again" in errors and "steps/s" in errors, errors
        assert f.summary(name)["status"] == "stopped" and "--resume" in output
        f.check_whole(name)
    return "3 signals"


def ended_children():
    """processor time of all processes that have ended"""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def used_by(process):
    """processor time of a process"""
    words = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return (float(words[11]) + float(words[12])) / os.sysconf("SC_CLK_TCK")


def ends_soon(f, scene, limit, pause=0.5):
    """processor time after a signal within the first long step, which takes many seconds and leaves the state before it; the signal comes
    after so much processor time of that step"""
    frequency = 20 if os.environ.get("PELLICLE_SANITIZE") else 50 if "PELLICLE_ALL" in os.environ else 40
    (f.folder / "long.yaml").write_text(scene % frequency)
    ended = ended_children()
    # a folder of its own: in one of a run before the first frame would be there already
    folder = f"long{len(list(f.folder.glob('long*')))}"
    process = f.start("run", "long.yaml", "-o", folder, "--progress", "plain")
    f.wait_for(f"{folder}/frames/f00000.vtp", process)
    start = used_by(process)
    while used_by(process) < start + pause:
        assert process.poll() is None, "the step is not long"
        time.sleep(0.01)
    before = used_by(process)
    process.send_signal(signal.SIGTERM)
    _, errors = process.communicate(timeout=300)
    seconds = ended_children() - ended - before
    assert process.returncode == 1 and ("stopped at step 0" in errors or "stopped at step 1" in errors), (process.returncode, errors)
    assert f.summary(folder)["status"] == "stopped"
    f.check_whole(folder)
    # of all threads, however busy the machine is; sanitizers take three times as long
    assert seconds < (3 if os.environ.get("PELLICLE_SANITIZE") else 1) * limit, f"{seconds:.1f} s"
    return f"{seconds:.2f} s of processor time"


def stopped_within(f):
    """a signal within an analysis"""
    return ends_soon(f, LONG, 1)


def stopped_in_jam(f):
    """a signal while a shell is crushed between plates; pbd has one substep, whose steps are short as a rule"""
    return ", ".join(f"{method} {ends_soon(f, JAM.replace('METHOD', method), 0.5, pause)}" for method, pause in (("xpbd", 0.5), ("pbd", 1)))


def piled(f):
    """rigid balls in a jam: pairs beyond the memory end a part of a step, never the program"""
    balls = [f"  - {{ name: b{i}, mesh: {{ shape: geodesic-sphere, frequency: 2, radius: 0.05, translate: [{0.1001 * (i % 3):g}, {0.1001 * (i // 3 % 3):g}, "
             f"{0.0501 + 0.1001 * (i // 9):g}] }}, rigid: {{}} }}" for i in range(27)]
    (f.folder / "pile.yaml").write_text(PILE % "\n".join(balls))
    status, _, errors = f.run("run", "pile.yaml", "-o", "pile", "-q")
    assert status == 0, (status, errors)
    return "held"


def file_limit(f):
    """ulimit -f: a message instead of a signal, and the checkpoint where it fits"""
    said = set()
    for size in (400, 3000, 20000, 40000, 200000):
        status, _, errors = f.run("run", "scene.yaml", "-q", "-o", "limited", limits={resource.RLIMIT_FSIZE: size})
        if status == 0:
            continue
        assert status in (1, 2) and "File too large" in errors and "ulimit -f" in errors, (size, status, errors)
        f.check_whole("limited")
        said.add(status)
    assert said, "no limit was met"
    status, _, errors = f.run("shape", "geodesic-sphere", "-o", "big.ply", limits={resource.RLIMIT_FSIZE: 1000})
    assert status == 2 and "File too large" in errors and not (f.folder / "big.ply").exists(), (status, errors)
    return "named"


def full_disk(f):
    """a small file system of its own, where one can be mounted"""
    script = """set -e; mkdir -p full; mount -t tmpfs -o size=300k none full
        set +e; "$0" run scene.yaml -q -o full/none; echo "refused $?"; ls full
        "$0" run scene.yaml -q -o full/run --set stop.at_rest=1e-12; echo "status $?"; ls full/run
        rm -rf full/*; "$0" run scene.yaml -q -o once --frames 3; head -c 303104 /dev/zero > full/fill; "$0" render once -q --size 320x180 -o full/film.mp4; echo "film $?"; ls full
        "$0" convert once full/sequence.obj; echo "export $?"; ls full"""
    result = subprocess.run(["unshare", "-rm", "bash", "-c", script, f.program], cwd=f.folder, capture_output=True,
                            text=True, check=False)
    if "status" not in result.stdout:
        return "not tried: no file system can be mounted"
    assert "refused 2" in result.stdout and "none" not in result.stdout and "and the disk has 0.0003" in result.stderr, result.stdout + result.stderr
    assert "status 1" in result.stdout and "No space left" in result.stderr, result.stdout + result.stderr
    assert "film 0" not in result.stdout and "film.mp4" not in result.stdout, result.stdout
    assert "checkpoint" in result.stdout and "summary.json" in result.stdout, result.stdout
    return "run and film fail with a message"


def many_frames(f):
    """what fills the disk is refused with numbers before anything is written; the numbers are those of the files"""
    status, _, errors = f.run("run", "scene.yaml", "-q", "-o", "many", "--set", "output.every=1e-12", "--set", "solver.dt=1e-7", "--set", "duration=1000")
    assert status == 2 and not (f.folder / "many").exists() and "10000000001 frames of " in errors and "in more files than 10000000" in errors, (status, errors)
    told = float(errors.split("frames of ")[1].split()[0]) * 1e6
    status, _, errors = f.run("run", "scene.yaml", "-q", "-o", "few", "--frames", "1")
    assert status == 0, errors
    written = (f.folder / "few/frames/f00001.vtp").stat().st_size + (f.folder / "few/series.csv").stat().st_size / 2
    assert 0.8 < told / written < 1.1, (told, written)
    return f"a frame takes {written:.0f} bytes, {told:.0f} are told"


def broken_film(f):
    """an ffmpeg that ends well and leaves half a film"""
    tools = f.folder / "tools"
    tools.mkdir()
    script = tools / "ffmpeg"
    script.write_text('#!/bin/bash\ncat > /dev/null\nprintf "\\0\\0\\0\\020ftypisom0000\\0\\0\\1\\0mdat" > "${@: -1}"\n')
    script.chmod(0o755)
    f.run("run", "scene.yaml", "-q", "-o", "filmed", "--frames", "2")
    process = subprocess.run([f.program, "render", "filmed", "-q", "--size", "320x180", "-o", "film.mp4"], cwd=f.folder, capture_output=True,
                             text=True, env=dict(os.environ, PATH=f"{tools}:{os.environ['PATH']}"), check=False)
    if "cannot draw" in process.stderr or "without pictures" in process.stderr:
        return "not tried: nothing can be drawn here"
    assert process.returncode == 2 and "incomplete" in process.stderr, process.stderr
    assert not [entry.name for entry in f.folder.glob("film.mp4*")]
    return "refused"


def read_only(f):
    """a folder that may not be written: nothing is left; for the superuser, who may write everywhere, a disk"""
    folder = f.folder / "closed"
    folder.mkdir()
    folder.chmod(0o555)
    if not os.access(folder, os.W_OK):
        status, _, errors = f.run("run", "scene.yaml", "-q", "-o", "closed/run")
        assert status == 2 and "Permission denied" in errors and not list(folder.iterdir()), errors
        return "folder refused"
    script = """set -e; mount -t tmpfs -o ro none closed
        set +e; "$0" run scene.yaml -q -o closed/run; echo "status $?"; ls closed"""
    result = subprocess.run(["unshare", "-rm", "bash", "-c", script, f.program], cwd=f.folder, capture_output=True, text=True, check=False)
    if "status" not in result.stdout:
        return "not tried: no file system can be mounted"
    assert result.stdout == "status 2\n" and "Read-only file system" in result.stderr, result.stdout + result.stderr
    return "disk refused"


def out_of_memory(f):
    """more and more address space: the run says that memory is out until it ends well; a scene that cannot fit is refused with numbers"""
    if os.environ.get("PELLICLE_SANITIZE"):
        return "not tried: a sanitizer needs the address space"
    said, resumable = 0, 0
    # 1.8 million triangles: their mesh fits, a scene of them does not
    (f.folder / "large.yaml").write_text(SCENE.replace("frequency: 5", "frequency: 300"))
    for command in (["run", "large.yaml", "-q", "-o", "large"], ["check", "large.yaml"]):
        status, _, errors = f.run(*command, limits={resource.RLIMIT_AS: 400 << 20})
        assert status == 2 and "1.8 million triangles, which need at least 0.45 GB of 0.419 GB" in errors, (status, errors)
    assert not (f.folder / "large").exists()
    # one block that is larger than all
    status, _, errors = f.run("run", "scene.yaml", "-q", "-o", "large", "--set", "bodies.0.mesh.frequency=2000", limits={resource.RLIMIT_AS: 400 << 20})
    assert status == 2 and "0.96 GB more were needed at once, of 0.419 GB in all" in errors, (status, errors)
    for megabytes in range(24, 900, 3 if "PELLICLE_ALL" in os.environ else 8):
        status, _, errors = f.run("run", "scene.yaml", "-q", "-o", "small", "--frames", "1", "--threads", "1",
                                  "--set", "bodies.0.mesh.frequency=50", limits={resource.RLIMIT_AS: megabytes << 20})
        if status == 0:
            break
        if "shared lib" not in errors and "find-object" not in errors:
            assert status in (1, 2) and "error: out of memory" in errors and not errors.startswith("error:"), (megabytes, status, errors)
            assert status == 1 or not (f.folder / "small" / "frames").exists(), (megabytes, errors)
            said += 1
            resumable += "the last good state" in errors
            f.check_whole("small")
    assert status == 0 and said > 1, said
    return f"refused at {said} limits, {resumable} of them with a checkpoint"


def locked(f):
    """a second run into the folder is refused and says who is there; the lock goes with the run, killed or not"""
    for ending in (signal.SIGTERM, signal.SIGKILL):
        name = f"shared{ending}"
        process = f.start("run", "scene.yaml", "-q", "-o", name, "--set", "duration=100000")
        f.wait_for(f"{name}/frames/f00001.vtp", process)
        status, _, errors = f.run("run", "scene.yaml", "-q", "-o", name)
        assert status == 2 and f"process {process.pid}" in errors, errors
        process.send_signal(ending)
        process.communicate()
        status, _, errors = f.run("run", "scene.yaml", "-q", "-o", name)
        assert status == 0 and not (f.folder / name / ".pellicle-lock").exists(), errors
    return "held and freed"


def links(f):
    """report, render and convert read nothing that lies outside the folder"""
    f.run("run", "scene.yaml", "-q", "-o", "run", "--frames", "2")
    outside = f.folder / "outside"
    outside.mkdir()
    (outside / "secret.vtp").write_bytes((f.folder / "run" / "frames" / "f00001.vtp").read_bytes())
    (outside / "secret.csv").write_text("secret,1\n")
    pvd = f.folder / "run" / "frames.pvd"
    whole = pvd.read_text()
    (f.folder / "page.html").write_text("<html><script id=\"runs\"></script></html>")
    for name in ("../outside/secret.vtp", str(outside / "secret.vtp"), "frames/../../outside/secret.vtp"):
        pvd.write_text(whole.replace("frames/f00001.vtp", name))
        for command in (("convert", "run", "out.obj"), ("render", "run", "-o", "out.png"), ("convert", "run", "out.pc2")):
            status, _, errors = f.run(*command)
            assert status == 2 and ("outside" in errors or "cannot draw" in errors), (name, command, errors)
    pvd.write_text(whole)
    frame = f.folder / "run" / "frames" / "f00001.vtp"
    frame.unlink()
    frame.symlink_to(outside / "secret.vtp")
    status, _, errors = f.run("convert", "run", "out.obj")
    assert status == 2 and "outside the folder of the run" in errors, errors
    frame.unlink()
    frame.write_bytes((outside / "secret.vtp").read_bytes())
    for name in ("series.csv", "summary.json", "scene.yaml"):
        path = f.folder / "run" / name
        content = path.read_bytes()
        path.unlink()
        path.symlink_to(outside / "secret.csv")
        status, _, errors = f.run("report", "run", "-o", "report.html", "-q")
        assert status == 2 and not (f.folder / "report.html").exists(), (name, errors)
        path.unlink()
        path.write_bytes(content)
    return "refused"


def inputs(f):
    """pipes and devices are refused at once, in every place where a file is read"""
    os.mkfifo(f.folder / "pipe.obj")
    os.mkfifo(f.folder / "pipe.yaml")
    for command in (("check", "pipe.obj"), ("info", "pipe.obj"), ("run", "pipe.yaml"), ("check", "/dev/zero"),
                    ("convert", "pipe.obj", "a.ply"), ("run", "scene.yaml", "--resume", "pipe.obj", "-o", "x")):
        process = f.start(*command)
        _, errors = process.communicate(timeout=30)
        assert process.returncode == 2 and ("pipe" in errors or "device" in errors), (command, errors)
    return "refused"


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    failures = 0
    for fault in (killed, stopped, stopped_within, stopped_in_jam, piled, file_limit, full_disk, many_frames, broken_film, read_only, out_of_memory, locked, links, inputs):
        with tempfile.TemporaryDirectory() as folder:
            try:
                print(f"{fault.__name__}: {fault(Faults(program, folder))}")
            except (AssertionError, subprocess.TimeoutExpired) as error:
                failures += 1
                print(f"{fault.__name__}: FAILED: {error}")
    sys.exit(1 if failures else 0)


main()

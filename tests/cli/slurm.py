#!/usr/bin/env python3
"""`pellicle sweep --slurm` on a real Slurm: starts munged, slurmctld and slurmd for one node on 127.0.0.1 in a folder of its
own, submits a study, and compares the table with that of this process. Starts daemons as root: only done when asked for.

usage: PELLICLE_TEST_SLURM=1 slurm.py PROGRAM
"""
import os
import pathlib
import secrets
import shutil
import socket
import subprocess
import sys
import tempfile
import time

SKIPPED = 77
NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo")
SECONDS = 120

CONFIGURATION = """ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmdPort={other}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
MpiDefault=none
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""

SCENE = """version: 1
bodies: [{ name: ball, preset: paper-a, mesh: { shape: geodesic-sphere, frequency: 3 }, mass: { per_vertex: 1 } }]
loads: [{ name: finger, body: ball, force: [0, 0, -1], at: { nearest: [0, 0, 1] } }]
solver: { method: quasi-static, alpha: 20, dt: 0.01 }
duration: 0.5
"""
STUDY = """scene: scene.yaml
vary: { bodies.ball.springs.stiffness: { from: 1, to: 3, sobol: 32 } }
measure: [max_displacement, state_hash]
"""


def skip(why):
    print(why)
    sys.exit(SKIPPED)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def start(words, daemons, environment):
    daemons.append(subprocess.Popen(words, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))


def wait_for(what, holds):
    end = time.monotonic() + SECONDS
    while not holds():
        if time.monotonic() > end:
            raise RuntimeError(f"{what} took more than {SECONDS} s")
        time.sleep(0.2)


def output(words, environment):
    return subprocess.run(words, env=environment, capture_output=True, text=True).stdout


def start_slurm(folder, daemons):
    for name in ("state", "spool"):
        (folder / name).mkdir()
    key = folder / "munge.key"
    key.write_bytes(secrets.token_bytes(1024))
    key.chmod(0o400)
    environment = dict(os.environ, SLURM_CONF=str(folder / "slurm.conf"))
    (folder / "slurm.conf").write_text(
        CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], folder=folder, port=free_port(), other=free_port(), cpus=os.cpu_count()
        )
    )
    munge = [f"--{name}={folder}/munge.{ending}" for name, ending in
             (("key-file", "key"), ("socket", "socket"), ("log-file", "log"), ("pid-file", "pid"), ("seed-file", "seed"))]
    start(["munged", "--foreground", "--force", *munge], daemons, environment)
    wait_for("munged", (folder / "munge.socket").exists)
    start(["slurmctld", "-D"], daemons, environment)
    start(["slurmd", "-D"], daemons, environment)
    wait_for("the node", lambda: "idle" in output(["sinfo", "-h", "-o", "%T"], environment))
    return environment


def compare(program, folder, environment):
    (folder / "scene.yaml").write_text(SCENE)
    (folder / "study.yaml").write_text(STUDY)
    sweep = [program, "sweep", str(folder / "study.yaml"), "-q", "-o"]
    subprocess.run([*sweep, str(folder / "here")], check=True)
    subprocess.run([*sweep, str(folder / "slurm"), "--slurm", "--chunks", "5"], check=True, env=environment)
    table = folder / "slurm/runs.csv"
    wait_for("the job array", lambda: table.exists() and not output(["squeue", "-h"], environment))
    return table.read_bytes() == (folder / "here/runs.csv").read_bytes()


def main():
    if not os.environ.get("PELLICLE_TEST_SLURM"):
        skip("long: PELLICLE_TEST_SLURM=1 starts a Slurm of one node, as root")
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    missing = [name for name in NEEDED if shutil.which(name) is None]
    if missing or os.getuid() != 0:
        skip(f"missing: needs root and {', '.join(NEEDED)}")
    daemons = []
    with tempfile.TemporaryDirectory(prefix="pellicle-slurm-") as place:
        folder = pathlib.Path(place)
        folder.chmod(0o755)
        try:
            same = compare(sys.argv[1], folder, start_slurm(folder, daemons))
        except Exception:
            for log in sorted(folder.glob("*.log")):
                print(f"--- {log.name}\n{log.read_text(errors='replace')[-2000:]}")
            raise
        finally:
            for daemon in reversed(daemons):
                daemon.terminate()
                daemon.wait()
    print("the table is the same" if same else "the table differs")
    sys.exit(0 if same else 1)


main()

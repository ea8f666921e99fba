"""The program in the background: a run, then its point cache."""

import os
import re
import signal
import subprocess

STEP = re.compile(r"step (\d+)/(\d+)")
RUNNING, DONE, STOPPED, FAILED = "running", "done", "stopped", "failed"


class Job:
    """Runs a scene and exports its frames; poll() leads it on and never waits.

    state: running, done, stopped (by the user: the frames until then are there) or failed; progress: 0 to 1; messages: the warnings and
    errors of the program."""

    def __init__(self, program, scene, run, cache, log):
        self.program, self.scene, self.run, self.cache, self.log_path = program, scene, run, cache, log
        self.state, self.progress, self.messages = RUNNING, 0.0, []
        self.log = self.process = None
        self.is_exporting = self.is_stopping = False
        self.start("run", scene, "-o", run, "--overwrite", "--progress", "plain")

    def start(self, *arguments):
        # a file takes everything that the program says, so that it never waits for a reader
        try:
            with open(self.log_path, "wb") as log:
                self.process = subprocess.Popen([self.program, *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=log)
            self.log = open(self.log_path, "rb")
        except OSError as error:
            self.finish(FAILED, f"cannot run {self.program}: {error.strerror}")

    def finish(self, state, message=None):
        self.state = state
        if message:
            self.messages.append(message)
        if self.log is not None:
            self.log.close()

    def read_log(self):
        place = self.log.tell()
        text = self.log.read()
        # a line that is not whole is read later
        end = text.rfind(b"\n") + 1
        self.log.seek(place + end)
        for line in text[:end].decode(errors="replace").splitlines():
            step = STEP.match(line)
            if step:
                self.progress = int(step[1]) / max(1, int(step[2]))
            elif "warning:" in line or "error:" in line:
                self.messages.append(line)

    def poll(self):
        """Takes what the program has said since; returns the state."""
        if self.state != RUNNING:
            return self.state
        code = self.process.poll()
        self.read_log()
        if code is None:
            return self.state
        if code != 0 and not (self.is_stopping and not self.is_exporting):
            told = any("error:" in message for message in self.messages)
            self.finish(FAILED, None if told else f"pellicle ended with status {code}")
        elif self.is_exporting:
            self.progress = 1.0 if not self.is_stopping else self.progress
            self.finish(STOPPED if self.is_stopping else DONE)
        else:
            self.log.close()
            self.is_exporting = True
            self.start("convert", self.run, self.cache, "--quiet")
        return self.state

    def stop(self):
        """Asks the program to stop; poll() then exports the frames until there."""
        if self.state == RUNNING and not self.is_stopping:
            self.is_stopping = True
            if os.name == "nt":
                self.process.terminate()
            else:
                self.process.send_signal(signal.SIGINT)

    def kill(self):
        """Ends the program at once."""
        if self.state == RUNNING:
            self.process.kill()
            self.process.wait()
            self.finish(FAILED)

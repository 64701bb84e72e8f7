"""More than one process: mpirun pvbatch gives the mesh of one process, and a client that of its
server."""

import json
import os
import socket
import subprocess
import sys
import time
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
# Seconds; a program of ParaView starts in 1 to 3.
TIMEOUT = 120


def run(*command):
    """The JSON objects that a program prints, one a process."""
    result = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, timeout=TIMEOUT
    )
    lines = [line for line in result.stdout.splitlines() if line.startswith("{")]
    if result.returncode != 0 or not lines:
        raise AssertionError(f"{command} failed:\n{result.stdout}\n{result.stderr}")
    return [json.loads(line) for line in lines]


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


class TestProcesses(unittest.TestCase):
    def test_mpi(self):
        script = os.path.join(HERE, "mesh_in_pieces.py")
        (alone,) = run(os.environ["MLIM_PVBATCH"], "--symmetric", script)
        ranks = run(
            os.environ["MLIM_MPIEXEC"], "-n", 2, os.environ["MLIM_PVBATCH"], "--symmetric", script
        )
        ranks.sort(key=lambda report: report["rank"])
        self.assertEqual([report["rank"] for report in ranks], [0, 1])
        for stage in ("curves", "balls", "surface", "regions"):
            first, second = ranks[0][stage], ranks[1][stage]
            self.assertEqual(first["digest"], alone[stage]["digest"], stage)
            self.assertGreater(first["points"], 0)
            self.assertEqual(second["points"], 0, stage)
            self.assertEqual(second["cells"], 0, stage)
            self.assertEqual(second["arrays"], first["arrays"], f"{stage}: empty but typed")

    def test_client_and_server(self):
        script = os.path.join(HERE, "mesh_as_client.py")
        (alone,) = run(os.environ["MLIM_PVPYTHON"], script)
        port = free_port()
        server = subprocess.Popen(
            [os.environ["MLIM_PVSERVER"], f"--server-port={port}"],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        try:
            for line in server.stdout:
                if "Accepting connection" in line:
                    break
            (remote,) = run(os.environ["MLIM_PVPYTHON"], script, port)
            end = time.monotonic() + 10
            while server.poll() is None and time.monotonic() < end:
                time.sleep(0.1)
        finally:
            if server.poll() is None:
                server.kill()
            server.wait()
            server.stdout.close()
        self.assertEqual(remote, alone)
        self.assertGreater(alone["triangles"], 1000)


if __name__ == "__main__":
    if not os.environ.get("DISPLAY"):
        print("skipped: no display")
        sys.exit(77)
    unittest.main()

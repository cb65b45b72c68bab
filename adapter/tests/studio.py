#!/usr/bin/env python3
"""The studio's command line at the emulated adapter, over TCP: studio.py STUDIO FIRMWARE.uf2

Each encoder counts the frames that were read from it, so that a wrong, a missed and a repeated frame show in the next
position. Streams are read by a host in Python (tests/foreign/bridge_host.py of the studio). All figures are emulated.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
SERVE = HERE.parent / "emulator/src/serve.mjs"
HOST = HERE.parent.parent / "tests/foreign/bridge_host.py"
STUDIO, FIRMWARE = "", ""


class Adapter:
    """The emulated adapter with an encoder, as a context."""

    def __init__(self, *options):
        self.options = options

    def __enter__(self):
        self.process = subprocess.Popen(["node", str(SERVE), FIRMWARE, *self.options], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)
        ready = self.process.stdout.readline().split()
        assert ready[:1] == ["ready"], f"the emulator has not started: {ready}"
        self.address = ready[1]
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.wait(10)
        self.process.stdout.close()

    def studio(self, *arguments):
        """Returns the lines that the studio prints, and fails with its message."""
        link = f"--link=bridge:{self.address}"
        with tempfile.TemporaryDirectory() as home:
            names = "HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME"
            run = subprocess.run([STUDIO, *arguments, link], capture_output=True, text=True, timeout=120,
                                 env=os.environ | {name: home for name in names})
        assert run.returncode == 0, f"{arguments}: {run.stderr}"
        return run.stdout.splitlines()

    def host(self, *arguments):
        """Returns what the host in Python has found out: a value for each argument."""
        run = subprocess.run([sys.executable, str(HOST), self.address, *arguments], capture_output=True, text=True, timeout=60)
        assert run.returncode == 0, run.stderr
        return [json.loads(line) for line in run.stdout.splitlines()]


class Ssi(unittest.TestCase):
    # Layout of the studio, options of the encoder, bits of the steps, first position: a turn ends within the first frames.
    LAYOUTS = [
        ("atm60,code=gray", "25:gray", 13, (0x5A5 << 13) - 100),
        ("afs60", "18:binary:3", 18, (1 << 18) - 100),
        ("ahm36,code=gray", "26:gray:1", 14, (0x123 << 14) - 100),
        ("afm60,st=18", "30:binary:3", 18, (0x5A5 << 18) - 100),
        ("ttk70", "24:binary:2", 24, 0xABCDEF),
    ]
    FRAMES = 250

    def test_five_layouts_have_no_wrong_frame(self):
        for layout, encoder, step_bits, start in self.LAYOUTS:
            with self.subTest(layout), Adapter("--ssi", encoder, "--start", str(start)) as adapter:
                lines = adapter.studio("position", "ssi", "--layout", layout, "--count", str(self.FRAMES), "--interval", "0",
                                       "--json")
                self.assertEqual(len(lines), self.FRAMES)
                readings = [json.loads(line) for line in lines]
                total = sum(int(part) for part in [encoder.split(":")[0]])
                for number, reading in enumerate(readings, start):
                    position = number % (1 << total)
                    expected = position & (1 << step_bits) - 1, position >> step_bits
                    self.assertEqual((reading["steps"], reading["turns"] or 0), expected, f"frame {number - start}")
                    self.assertTrue(reading["valid"] and reading["errors"] == [])

    def test_a_stream_at_1_khz_loses_nothing(self):
        with Adapter("--ssi", "25:gray") as adapter:
            hello, ssi, words = adapter.host("hello", "ssi:25:1000000:30", "words:1000:4:12,13,gray,0")
            self.assertEqual((hello["version"], hello["name"]), (1, "Encoder adapter"))
            self.assertEqual(ssi, {"clock_hz": 1_000_000})
            self.assertGreater(words["words"], 3_500)
            self.assertEqual([words[name] for name in ("period_us", "ended", "broken", "gaps", "lost", "off_time")],
                             [1000, True, 0, 0, 0, 0])
            self.assertEqual((words["least_move"], words["greatest_move"]), (1, 1))

    def test_the_next_program_finds_a_free_adapter(self):
        with Adapter("--ssi", "25:gray") as adapter:
            # A host that ends within a stream, without a word.
            host = subprocess.Popen([sys.executable, str(HOST), adapter.address, "ssi:25:1000000:30",
                                     "words:1000:60:12,13,gray,0"], stdout=subprocess.PIPE, text=True)
            self.assertIn("clock_hz", host.stdout.readline())
            host.kill()
            host.communicate()
            lines = adapter.studio("position", "ssi", "--layout", "atm60,code=gray", "--count", "20", "--interval", "0",
                                   "--json")
            steps = [json.loads(line)["steps"] for line in lines]
            self.assertEqual([after - before for before, after in zip(steps, steps[1:])], [1] * 19)


class Identity(unittest.TestCase):
    def test_the_studio_identifies_the_adapter(self):
        version = next(line.split('"')[1] for line in (HERE.parent / "Cargo.toml").read_text().splitlines()
                       if line.startswith("version"))
        with Adapter("--biss") as adapter:
            told = adapter.studio("identify", "biss")
        self.assertIn(f"Encoder adapter, serial number 1, firmware {version}", told[-1])


if __name__ == "__main__":
    STUDIO, FIRMWARE = (str(pathlib.Path(path).resolve()) for path in sys.argv[1:3])
    unittest.main(argv=[sys.argv[0], "-v", *sys.argv[3:]])

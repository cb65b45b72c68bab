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
        # A busy computer may emulate slowly, so that replies are late.
        link = f"--link=bridge:{self.address}?margin=2000"
        with tempfile.TemporaryDirectory() as home:
            names = "HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME"
            run = subprocess.run([STUDIO, *arguments, link], capture_output=True, text=True, timeout=120,
                                 env=os.environ | {name: home for name in names})
        assert run.returncode == 0, f"{arguments}: {run.stderr}"
        assert "lost" not in run.stderr, f"{arguments}: {run.stderr}"
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
            self.assertGreater(words["words"], 1_000)
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


class Biss(unittest.TestCase):
    FRAMES = 1000

    def test_the_studio_identifies_the_adapter_and_the_encoder(self):
        version = next(line.split('"')[1] for line in (HERE.parent / "Cargo.toml").read_text().splitlines()
                       if line.startswith("version"))
        with Adapter("--biss") as adapter:
            told = adapter.studio("identify", "biss")
            encoder = json.loads("\n".join(adapter.studio("identify", "biss", "--json")))
        self.assertRegex(told[-1], f"Encoder adapter, serial number [0-9A-F]+, firmware {version}$")
        # Registers of the model; the temperature is register 66h less 50.
        expected = {"adapter": "Encoder adapter", "profile_id": "6129", "device_id": "010168110001", "manufacturer": "Fr",
                    "serial_number": str(0x12345678), "firmware": "1.6.0", "multiturn_bits": 16, "singleturn_bits": 17,
                    "temperature_c": 25.0}
        self.assertEqual({name: encoder[name] for name in expected}, expected)

    def test_a_thousand_frames_have_no_wrong_one(self):
        # The studio reads some frames before, while it identifies the encoder.
        with Adapter("--biss", "--start", str(0xA5A5 << 17), "--delay", "400") as adapter:
            lines = adapter.studio("position", "biss", "--count", str(self.FRAMES), "--interval", "0", "--json")
        readings = [json.loads(line) for line in lines]
        self.assertEqual(len(readings), self.FRAMES)
        self.assertTrue(all(reading["valid"] for reading in readings))
        positions = [reading["turns"] << 17 | reading["steps"] for reading in readings]
        self.assertEqual([after - before for before, after in zip(positions, positions[1:])], [1] * (self.FRAMES - 1))
        self.assertEqual({reading["turns"] for reading in readings}, {0xA5A5})

    def test_registers_are_written_and_read_back(self):
        # Data are written only while the shaft is at rest.
        with Adapter("--biss", "--still") as adapter:
            self.assertIn("4B", " ".join(adapter.studio("read", "biss", "0x66")))
            adapter.studio("write", "biss", "0x24:0x10+4", "C0FFEE01", "--yes")
            told = " ".join(adapter.studio("read", "biss", "0x24:0x10+4"))
        self.assertIn("C0FFEE01", told.replace(" ", ""))

    def test_a_stream_at_1_khz_loses_nothing(self):
        with Adapter("--biss") as adapter:
            _, frames = adapter.host("config:2000000:35:6:20", "stream:1000:4")
        self.assertGreater(frames["frames"], 1_000)
        self.assertEqual([frames[name] for name in ("ended", "broken", "gaps", "lost", "wrong_crc", "bad_status", "off_time")],
                         [True, 0, 0, 0, 0, 0, 0])
        self.assertEqual(frames["last_steps"] - frames["first_steps"], frames["frames"] - 1)


class SineCosine(unittest.TestCase):
    def test_the_analysis_gives_what_is_modelled(self):
        sine, cosine, sine_offset, cosine_offset = 0.5, 0.475, 0.06, -0.045
        # The cosine is converted 2 µs after the sine, which would be a phase error of 0.72° at 1 kHz.
        for hz, rate, seconds in [(1000, 100_000, 0.2), (5000, 100_000, 0.1), (100, 20_000, 0.3)]:
            with self.subTest(hz), Adapter("--sine", f"{hz},{sine},{cosine},{sine_offset},{cosine_offset}") as adapter:
                found = json.loads("\n".join(adapter.studio("analyse", "--seconds", str(seconds), "--rate", str(rate), "--json")))
            self.assertGreaterEqual(found["samples"], rate * seconds)
            for name, expected in [("offset_sin_v", sine_offset), ("offset_cos_v", cosine_offset), ("frequency_hz", hz),
                                   ("gain_ratio", cosine / sine)]:
                self.assertLess(abs(found[name] - expected), abs(expected) / 100, f"{hz} Hz: {name} {found[name]}")
            self.assertLess(abs(found["phase_error_deg"]), 0.05, f"{hz} Hz: the skew is corrected")


if __name__ == "__main__":
    STUDIO, FIRMWARE = (str(pathlib.Path(path).resolve()) for path in sys.argv[1:3])
    unittest.main(argv=[sys.argv[0], "-v", *sys.argv[3:]])

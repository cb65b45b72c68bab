//! The `analyse` command: it returns the parameters used to make synthetic captures, and reports invalid captures in
//! one sentence.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use super::support::Bench;

/// The parameters R, p, q, r, and α in degrees, as defined in the program's documentation.
#[derive(Clone, Copy)]
struct Signal {
    amplitude: f64,
    offset_cosine: f64,
    offset_sine: f64,
    ratio: f64,
    phase_deg: f64,
}

/// The example signal from section 7 of the reference.
const REFERENCE: Signal =
    Signal { amplitude: 0.5, offset_cosine: 0.02, offset_sine: -0.03, ratio: 1.05, phase_deg: 3.0 };

/// Returns the sine and cosine at an angle given in periods.
fn at(signal: &Signal, periods: f64) -> (f64, f64) {
    let (angle, phase) = (TAU * periods, signal.phase_deg.to_radians());
    let sine = (signal.amplitude * angle.sin() * phase.cos() - signal.amplitude * angle.cos() * phase.sin())
        / signal.ratio
        + signal.offset_sine;
    (sine, signal.amplitude * angle.cos() + signal.offset_cosine)
}

fn rows(signal: &Signal, count: usize, from: f64, periods: f64) -> Vec<[f64; 3]> {
    (0..count)
        .map(|i| {
            let (sine, cosine) = at(signal, from + periods * i as f64 / count as f64);
            [i as f64 * 1e-6, sine, cosine]
        })
        .collect()
}

fn table(header: &str, rows: &[[f64; 3]]) -> String {
    rows.iter().fold(header.to_owned(), |mut text, [t, sine, cosine]| {
        writeln!(text, "{t:.6},{sine:.9},{cosine:.9}").unwrap();
        text
    })
}

#[track_caller]
fn near(told: &Value, key: &str, expected: f64, tolerance: f64) {
    let value = told[key].as_f64().unwrap_or_else(|| panic!("{key} is no number in {told}"));
    assert!((value - expected).abs() <= tolerance, "{key}: {value} instead of {expected} in {told}");
}

#[test]
fn recovers_reference_signal() {
    let bench = Bench::new();
    // Either 360 points of a period or the six points at 0, 60 … 300°. They cover one step less than the period.
    for (count, header) in [(360, "time,sin,cos\n"), (6, "")] {
        let file = bench.write("c.csv", table(header, &rows(&REFERENCE, count, 0.0, 1.0)));
        let told = bench.run(&["analyse", &file, "--json"]).json();
        near(&told, "amplitude_v", 0.5, 1e-7);
        near(&told, "offset_cos_v", 0.02, 1e-7);
        near(&told, "offset_sin_v", -0.03, 1e-7);
        near(&told, "gain_ratio", 1.05, 1e-6);
        near(&told, "phase_error_deg", 3.0, 1e-5);
        near(&told, "periods", 1.0 - 1.0 / count as f64, 1e-7);
        near(&told, "residual_rms", 0.0, 1e-7);
        near(&told, "error_pp_deg_corrected", 0.0, 1e-4);
        // Calculated in Python: max − min of degrees(atan2(y, x)) − θ over 720 angles from 0° is 2.310392 + 7.660480.
        near(&told, "error_pp_deg_raw", 9.970_873, 1e-4);
    }
}

/// The noise is 2 mV rms at an amplitude of 0.5 V, with 1000 points per period over 7.25 periods. The standard
/// deviation of a parameter is σ·√(2/n) = 33 µV. The limit is five standard deviations.
#[test]
fn noise_error_stays_within_statistics() {
    let bench = Bench::new();
    let mut noise = fastrand::Rng::with_seed(11);
    let mut rows = rows(&REFERENCE, 7250, 0.3, -7.25);
    for value in rows.iter_mut().flat_map(|row| &mut row[1..]) {
        *value += 2e-3 * ((0..12).map(|_| noise.f64()).sum::<f64>() - 6.0);
    }
    let file = bench.write("c.csv", table("t [s],sine [V],cosine [V]\n", &rows));
    let told = bench.run(&["analyse", &file, "--json"]).json();
    let scatter = 2e-3 * (2.0 / 7250.0_f64).sqrt();
    near(&told, "amplitude_v", 0.5, 5.0 * scatter);
    near(&told, "offset_cos_v", 0.02, 5.0 * scatter);
    near(&told, "offset_sin_v", -0.03, 5.0 * scatter);
    near(&told, "gain_ratio", 1.05, 20.0 * scatter);
    near(&told, "phase_error_deg", 3.0, (20.0 * scatter).to_degrees());
    near(&told, "periods", 7.25, 0.01);
    near(&told, "residual_rms", 0.004, 0.0004);
    near(&told, "error_pp_deg_raw", 9.97, 0.1);
    near(&told, "error_pp_deg_corrected", 0.0, 0.1);
}

#[test]
fn detects_columns_and_units() {
    let bench = Bench::new();
    let rows = rows(&REFERENCE, 500, 0.0, 3.0);
    let plain = bench.run(&["analyse", &bench.write("p.csv", table("", &rows)), "--json"]).json();
    let german: String = rows
        .iter()
        .map(|[t, sine, cosine]| format!("{:.6};{:.9};{:.9}\n", cosine * 1e3, t * 1e3, sine * 1e3).replace('.', ","))
        .collect();
    let file = bench.write("g.csv", format!("cos [mV];Zeit [ms];sin [mV]\n{german}"));
    let counts: String =
        rows.iter().map(|[t, sine, cosine]| format!("7\t{t:.6}\t{:.3}\t{:.3}\n", cosine * 1e5, sine * 1e5)).collect();
    let counted = bench.write("n.csv", counts);
    let four: String = rows
        .iter()
        .map(|[t, sine, cosine]| format!("{t:.6},{:.9},2.5,{:.9},2.4\n", 2.5 + sine, 2.4 + cosine))
        .collect();
    let named = bench.write("f.csv", format!("time,SIN,REFSIN,COS,REFCOS\n{four}"));
    let numbered = bench.write("u.csv", four);
    for arguments in [
        &["analyse", &file, "--json"][..],
        &["analyse", &counted, "--columns", "2,4,3", "--volts-per-unit", "1e-5", "--json"],
        &["analyse", &named, "--json"],
        &["analyse", &numbered, "--columns", "1,2,3,4,5", "--json"],
    ] {
        let told = bench.run(arguments).json();
        for key in ["amplitude_v", "offset_sin_v", "offset_cos_v", "gain_ratio", "phase_error_deg", "periods"] {
            near(&told, key, plain[key].as_f64().unwrap(), 2e-5);
        }
        near(&told, "frequency_hz", plain["frequency_hz"].as_f64().unwrap(), 1.0);
    }
}

#[test]
fn bad_capture_fails_with_one_sentence() {
    let bench = Bench::new();
    let good = rows(&REFERENCE, 200, 0.0, 1.0);
    let made = |change: fn(&mut [f64; 3])| {
        let mut rows = good.clone();
        rows.iter_mut().for_each(change);
        table("time,sin,cos\n", &rows)
    };
    let text = table("time,sin,cos\n", &good);
    let cases: [(&str, String, &[&str]); 15] = [
        ("nothing", String::new(), &["is empty"]),
        ("only a header", "time,sin,cos\n".to_owned(), &["no row contains numbers"]),
        ("one column", "0.1\n0.2\n0.3\n".to_owned(), &["one column"]),
        ("two columns", "0,1\n1,2\n".to_owned(), &["2 columns"]),
        ("text", text.replace("0.000007,", "0.000007,oops"), &["row 9", "column 2", "oops"]),
        ("not a number", text.replace("0.000005,", "nan,"), &["row 7", "column 1", "nan"]),
        ("a short row", text.replace("0.000003,", "0.000003\n1,"), &["row 5", "1 of 3"]),
        ("five points", table("", &good[..5]), &["only 5 points"]),
        ("a fifth of a period", table("", &good[10..76]), &["octants", "whole period"]),
        ("constant", made(|row| *row = [row[0], 0.3, 0.2]), &["constant"]),
        ("no voltage", made(|row| *row = [row[0], 0.0, 0.0]), &["constant"]),
        ("dead sine", made(|row| row[1] = 1e-3 * (row[0] * 1e9).sin()), &["sine channel has no signal"]),
        ("dead cosine", made(|row| row[2] = 2.5), &["cosine channel has no signal"]),
        ("a line", made(|row| row[2] = 0.1 - 0.8 * row[1]), &["on a straight line"]),
        ("binary", "\u{0}\u{1}\u{2}\u{3}".repeat(50), &["no row contains numbers"]),
    ];
    for (label, text, words) in cases {
        let file = bench.write("bad.csv", text);
        for arguments in [&["analyse", &file, "--json"][..], &["analyse", &file]] {
            let ran = bench.run(arguments);
            ran.fails(1, words);
            assert_eq!(ran.err.lines().count(), 1, "{label}: {ran:?}");
            assert!(ran.err.contains("bad.csv"), "{label}: {ran:?}");
        }
    }
    bench.run(&["analyse", &bench.file("none.csv")]).fails(1, &["none.csv", "does not exist"]);
    bench.run(&["analyse", &bench.file("")]).fails(1, &["folder"]);
}

#[test]
fn spike_is_excluded_and_reported() {
    let bench = Bench::new();
    let mut rows = rows(&REFERENCE, 720, 0.0, 2.0);
    rows[123][1] = 4.5;
    let file = bench.write("spike.csv", table("time,sin,cos\n", &rows));
    let told = bench.run(&["analyse", &file, "--json"]).json();
    near(&told, "left_out", 1.0, 0.0);
    near(&told, "amplitude_v", 0.5, 1e-6);
    near(&told, "gain_ratio", 1.05, 1e-6);
    let text = bench.run(&["analyse", &file]).out;
    assert!(text.contains("720, 1 of them left out"), "{text}");
}

#[test]
fn wrong_usage_exits_with_status_2() {
    let bench = Bench::new();
    let file = bench.write("c.csv", table("", &rows(&REFERENCE, 100, 0.0, 1.0)));
    bench.run(&["analyse"]).fails(2, &["FILE.csv"]);
    bench.run(&["analyse", &file, "--link", "sim:"]).fails(2, &["FILE.csv"]);
    for seconds in ["0", "61", "NaN", "x"] {
        bench.run(&["analyse", "--link", "sim:", "--seconds", seconds]).fails(2, &["--seconds"]);
    }
    bench.run(&["analyse", "--link", "serial:/dev/null"]).fails(1, &["serial:"]);
    for columns in ["1,2", "0,1,2", "1,2,2", "a,b,c", "", "1,2,3,4"] {
        bench.run(&["analyse", &file, "--columns", columns]).fails(2, &["--columns"]);
    }
    for columns in ["1,2,3,reference=0", "1,2,3,reference=x", "1,2,3,angle=4", "1,2,3,absolute=3", "reference=4"] {
        bench.run(&["analyse", &file, "--columns", columns]).fails(2, &["--columns"]);
    }
    for periods in ["0", "-16", "x", "1.5", "10000000"] {
        bench.run(&["analyse", &file, "--periods", periods]).fails(2, &["--periods"]);
    }
    bench.run(&["analyse", &file, "--limits", "some"]).fails(2, &["--limits", "afs-afm60"]);
    for factor in ["0", "-1", "x", "nan", "inf"] {
        bench.run(&["analyse", &file, "--volts-per-unit", factor]).fails(2, &["--volts-per-unit"]);
    }
    bench.run(&["analyse", &file, "--columns", "1,2,9"]).fails(1, &["row 1", "3 of 9"]);
}

#[test]
fn example_captures_match_documentation() {
    let bench = Bench::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/signals");
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let good = bench.run(&["analyse", &path("healthy.csv")]);
    assert_eq!(good.status, Some(0), "{good:?}");
    assert!(good.out.contains("within the limits") && good.out.contains("periods"), "{good:?}");
    // The parameters R, p, q, r, α of the capture, which has 0.5 mV rms of noise on 400 points.
    let told = bench.run(&["analyse", &path("offset-gain-phase.csv"), "--json"]).json();
    let expected = [
        ("amplitude_v", 0.5, 2e-4),
        ("offset_cos_v", 0.04, 2e-4),
        ("offset_sin_v", -0.03, 2e-4),
        ("gain_ratio", 1.12, 1e-3),
        ("phase_error_deg", 6.0, 0.05),
        ("periods", 3.99, 0.01),
        ("frequency_hz", 2000.0, 5.0),
        ("residual_rms", 0.001, 3e-4),
        ("error_pp_deg_corrected", 0.0, 0.15),
    ];
    for (key, value, tolerance) in expected {
        near(&told, key, value, tolerance);
    }
    assert!(told["findings"].as_array().unwrap().len() >= 4, "{told}");
}

/// The capture was made in Python: 5000 rows of 0.05 ms, `turn = 1.25·i/5000`, `true = turn +
/// 120/1296000·sin(2π·turn)`, θ = 2π·16·true, cosine 0.49·cos θ + 0.010, sine 0.49·sin(θ − 2°)/1.04 − 0.015, 0.3 mV rms
/// of noise from `random.Random(16).gauss`, four decimals; reference `360·turn mod 360`, absolute `floor(32·16·true −
/// 0.5) mod 512`; decimal commas.
#[test]
fn example_revolution_shows_eccentricity() {
    let bench = Bench::new();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/signals/revolution-with-reference.csv");
    let path = path.to_str().unwrap();
    let ran = bench.run(&["analyse", path, "--json", "--periods", "16"]);
    assert_eq!(ran.err, "");
    let told = ran.json();
    // 1.25 revolutions in 250 ms are 300 1/min; a parameter scatters by 0.3 mV·√(2/5000) = 6 µV.
    near(&told, "speed_rpm", 300.0, 0.1);
    near(&told, "periods", 20.0, 0.01);
    near(&told, "amplitude_v", 0.49, 4e-5);
    near(&told, "offset_cos_v", 0.010, 4e-5);
    near(&told, "offset_sin_v", -0.015, 4e-5);
    near(&told, "gain_ratio", 1.04, 2e-4);
    near(&told, "phase_error_deg", 2.0, 0.01);
    // Averaging over a 16th of a revolution reduces 120″ by (π/16)²/6 = 0.6 %.
    near(&told, "inl_deg", 119.2 / 3600.0, 0.4 / 3600.0);
    near(&told, "inl_deg_corrected", 119.2 / 3600.0, 0.4 / 3600.0);
    // Calculated in Python: half of the peak-to-peak error of this ellipse, 5.801567° electrical, in 16 periods. Noise
    // of 0.035° reaches up to four times that on either side.
    near(&told, "dnl_deg", 0.181_3, 0.008);
    near(&told, "dnl_deg_corrected", 0.0, 0.012);
    let text = bench.run(&["analyse", path, "--periods", "16"]).out;
    assert!(
        text.contains("INL") && text.contains("300.0") && text.contains("within the limits of HIPERFACE"),
        "{text}"
    );

    // If the number of periods is missing, a hint is printed. If it is wrong, the message names the right number.
    let ran = bench.run(&["analyse", path, "--json"]);
    assert!(ran.json().get("inl_deg").is_none() && ran.err.contains("--periods"), "{ran:?}");
    let ran = bench.run(&["analyse", path, "--json", "--periods", "32"]);
    assert!(ran.json().get("inl_deg").is_none() && ran.err.contains("16.0 periods"), "{ran:?}");
    let columns = "1,2,3,reference=4,absolute=5";
    near(
        &bench.run(&["analyse", path, "--json", "--periods", "16", "--columns", columns]).json(),
        "inl_deg",
        0.0331,
        2e-4,
    );
    bench.run(&["analyse", path, "--columns", "1,2,3,absolute=4"]).fails(1, &["row 3", "column 4", "0.09"]);
}

#[test]
fn limits_come_from_named_family() {
    let bench = Bench::new();
    let weak = Signal { amplitude: 0.43, offset_cosine: 0.0, offset_sine: 0.0, ratio: 1.0, phase_deg: 0.0 };
    let file = bench.write("weak.csv", table("t,sin,cos\n", &rows(&weak, 400, 0.0, 3.0)));
    let verdict = |limits: &str| bench.run(&["analyse", &file, "--limits", limits]).out;
    assert!(verdict("hiperface").contains("the permitted range is 0.9 to 1.1 V"));
    assert!(verdict("ttk70").contains("the permitted range is 0.9 to 1.1 V"));
    assert!(verdict("afs-afm60").contains("within the limits of AFS/AFM60"));
}

#[test]
fn reports_interference_and_broken_wire() {
    let bench = Bench::new();
    let good = rows(&REFERENCE, 20_000, 0.0, 400.0);
    let disturbed: Vec<[f64; 3]> =
        good.iter().map(|[t, sine, cosine]| [*t, sine + 0.01 * (TAU * 8_000.0 * t).sin(), *cosine]).collect();
    let file = bench.write("drive.csv", table("t,sin,cos\n", &disturbed));
    let told = bench.run(&["analyse", &file, "--json"]).json();
    near(&told["interference"][0], "frequency_hz", 8_000.0, 2.0);
    near(&told["interference"][0], "amplitude_v", 0.01, 1e-4);
    assert!(
        told["findings"].to_string().contains("There is interference of 10.0 mV (2.0 % of the amplitude) at 8000 Hz"),
        "{told}"
    );
    // COS is at ground, and its reference is at 2.5 V.
    let wires = good.iter().fold("t,SIN,REFSIN,COS,REFCOS\n".to_owned(), |mut text, [t, sine, _]| {
        writeln!(text, "{t:.6},{:.6},2.5,0.02,2.5", sine + 2.5).unwrap();
        text
    });
    let file = bench.write("wire.csv", wires);
    bench.run(&["analyse", &file]).fails(1, &["cosine channel has no signal", "COS is at ground"]);
}

/// The frequency is 2 kHz at a sample interval of 2.5 µs. It is uncertain if the recorder was slow, the file contains a
/// second recording, or there are too few samples.
#[test]
fn uncertain_frequency_is_marked() {
    let bench = Bench::new();
    let row = |at: usize, step: f64| {
        let angle = TAU * 2_000.0 * step * at as f64;
        format!("{:.7},{:.6},{:.6}\n", at as f64 * step, 0.5 * angle.sin(), 0.5 * angle.cos())
    };
    let capture = |step: f64, rows: &mut dyn Iterator<Item = usize>| rows.map(|at| row(at, step)).collect::<String>();
    for (label, text, words) in [
        (
            "gap",
            capture(2.5e-6, &mut (0..2_000).chain(2_799..4_799)),
            "Samples are missing (gaps: 1, longest: 2.000 ms)",
        ),
        ("back", capture(2.5e-6, &mut (0..2_000).chain(0..2_000)), "The time of sample 2001 is earlier than"),
        ("coarse", capture(2.1e-4, &mut (0..2_000)), "There are only about 2.4 samples per period (151° apart)"),
    ] {
        let file = bench.write("c.csv", text);
        let told = bench.run(&["analyse", &file, "--json"]).json();
        near(&told, "frequency_hz", 2_000.0, 0.1);
        let findings: Vec<&str> = told["findings"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
        assert!(findings.iter().any(|finding| finding.starts_with(words)), "{label}: {findings:?}");
        let text = bench.run(&["analyse", &file]).out;
        assert_eq!(text.contains("Hz (uncertain"), label == "coarse", "{text}");
    }
}

/// The virtual adapter turns its shaft once per second. Its sampled signals are ideal.
#[test]
fn analyses_adapter_samples() {
    let bench = Bench::new();
    let arguments = ["analyse", "--link", "sim:?rpm=60", "--seconds", "0.2", "--rate", "20000", "--json"];
    let ran = bench.run(&arguments);
    assert!(ran.err.contains("virtual adapter: 20000 samples a second"), "{ran:?}");
    let told = ran.json();
    assert!((4_000..5_000).contains(&told["samples"].as_u64().unwrap()), "{told}");
    let amplitude = told["amplitude_v"].as_f64().unwrap();
    assert!((amplitude - 0.5).abs() < 0.05, "{told}");
}

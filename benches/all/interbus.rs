//! Measures the speed of evaluating 64 cams (goal: 10 million positions per second), compared with a loop over all
//! cams.
//!
//! `cargo bench -- interbus`

use crate::median;
use std::hint::black_box;

use encoder_studio::devices::interbus::protocol::{Cam, CompiledPrograms, Program, Value};

const POSITIONS: usize = 1 << 20;
const ROUNDS: usize = 9;

pub(crate) fn run() {
    let mut random = fastrand::Rng::with_seed(1);
    let mut any = || Value::new(random.u32(..=Value::MAX.get())).unwrap();
    let mut program = || Program { cams: [(); 8].map(|()| Some(Cam { start: any(), stop: any() })), mask: 0xFF };
    let programs = [(); 8].map(|()| program());
    let anywhere: Vec<Value> = (0..POSITIONS).map(|_| any()).collect();
    let turning: Vec<Value> = (0..POSITIONS).map(|at| Value::new(at as u32 * 31).unwrap()).collect();
    let compiled = CompiledPrograms::new(&programs);
    println!("8 programs of 8 cams, {POSITIONS} positions, medians of {ROUNDS}\n");
    for (name, positions) in [("any positions", &anywhere), ("a turning shaft", &turning)] {
        let mut outputs = vec![[0_u8; 8]; POSITIONS];
        let fast = median(ROUNDS, || {
            for (output, position) in outputs.iter_mut().zip(black_box(positions)) {
                *output = compiled.outputs(*position);
            }
            black_box(&outputs);
        });
        let plain = median(ROUNDS, || {
            for (output, position) in outputs.iter_mut().zip(black_box(positions)) {
                *output = programs.map(|program| program.outputs(*position));
            }
            black_box(&outputs);
        });
        let rate = |seconds: f64| POSITIONS as f64 / seconds / 1e6;
        println!("{name:16} compiled {:7.1}, a loop {:7.1} million positions/s", rate(fast), rate(plain));
    }
    let seconds = median(ROUNDS, || CompiledPrograms::new(black_box(&programs)));
    println!("\nthe programs are compiled in {:.0} µs", seconds * 1e6);
}

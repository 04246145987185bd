#![no_main]

#[path = "../src/detect.rs"]
mod driver;

libfuzzer_sys::fuzz_target!(|input: &[u8]| driver::drive(input));

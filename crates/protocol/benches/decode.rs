//! How fast line bytes become checked contents, beside the check alone by the `crc` crate over the
//! same bytes and its fastest one (slice-by-16), and beside the meaning that contents are given.
//!
//! Nothing here allocates: the crate is `no_std` without `alloc`.

#![allow(missing_docs)] // criterion's macros make a public function without a docstring.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rsapien_protocol::{
    ActionPackage, Address, Direction, Fed, HeaderByte, Receiver, SynchronizationPackage, frame,
};
use std::hint::black_box;

const PACKAGES: usize = 4096;

const ALGORITHM: crc::Algorithm<u16> = crc::Algorithm {
    width: 16,
    poly: 0x5935,
    init: 0xFFFF,
    refin: true,
    refout: true,
    xorout: 0,
    check: 0x328D,
    residue: 0,
};
const PEER: crc::Crc<u16> = crc::Crc::<u16>::new(&ALGORITHM);
const PEER_BY_16: crc::Crc<u16, crc::Table<16>> = crc::Crc::<u16, crc::Table<16>>::new(&ALGORITHM);

/// A line full of packages whose contents differ, without repeating soon.
fn line<const CONTENT: usize, const LINE: usize>(header: HeaderByte, sense: bool) -> Vec<u8> {
    let mut state = 1u64;
    let mut line = Vec::with_capacity(PACKAGES * LINE);
    for _ in 0..PACKAGES {
        let mut content = [0; CONTENT];
        for byte in &mut content {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            *byte = state.to_be_bytes()[0];
        }
        if sense {
            // A valid STEP, or an answer to one.
            content[2] = 0x11;
            if CONTENT == 12 {
                content[4] &= 0x3F;
                (content[5], content[7]) = (1, content[7] & 1);
                content[8] &= 0x3F;
                content[9..].fill(0);
            } else {
                (content[3], content[4], content[17]) =
                    (content[3] % 10, content[4] % 6, content[17] % 6);
                content[11] &= 0x3F;
            }
        }
        line.extend(frame::encode::<CONTENT, LINE>(header, &content));
    }
    line
}

fn count(receiver: &mut Receiver, mut line: &[u8]) -> usize {
    let mut packages = 0;
    while let (Some(content), rest) = receiver.feed_slice(line, 0) {
        black_box(&content);
        packages += 1;
        line = rest;
    }
    packages
}

fn count_byte_by_byte(receiver: &mut Receiver, line: &[u8]) -> usize {
    line.iter().filter(|byte| matches!(receiver.feed(**byte, 0), Fed::Package(_))).count()
}

fn decode(criterion: &mut Criterion) {
    for (name, direction) in [("action", Direction::ToRobot), ("synchronization", Direction::ToPc)]
    {
        let header = HeaderByte { direction, address: Address::Motion };
        let (receiver, line) = match direction {
            Direction::ToRobot => {
                (Receiver::for_robot(Address::Motion), line::<12, 18>(header, true))
            }
            Direction::ToPc => (Receiver::for_pc(), line::<18, 25>(header, true)),
        };
        assert_eq!(count(&mut receiver.clone(), &line), PACKAGES);
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Bytes(line.len() as u64));
        group.bench_function("decode", |bencher| {
            let mut receiver = receiver.clone();
            bencher.iter(|| count(&mut receiver, black_box(&line)));
        });
        group.bench_function("decode byte by byte", |bencher| {
            let mut receiver = receiver.clone();
            bencher.iter(|| count_byte_by_byte(&mut receiver, black_box(&line)));
        });
        group.bench_function("decode and parse", |bencher| {
            let mut receiver = receiver.clone();
            bencher.iter(|| {
                let mut understood = 0;
                let mut left = black_box(&line[..]);
                while let (Some(content), rest) = receiver.feed_slice(left, 0) {
                    left = rest;
                    understood += usize::from(match direction {
                        Direction::ToRobot => ActionPackage::parse(content.action()).is_ok(),
                        Direction::ToPc => SynchronizationPackage::parse(&content).is_ok(),
                    });
                }
                assert_eq!(understood, PACKAGES);
            });
        });
        group.bench_function("crc crate, check alone, each package", |bencher| {
            let length = line.len() / PACKAGES;
            bencher.iter(|| {
                let packages = black_box(&line).chunks_exact(length);
                packages.fold(0, |sum, package| sum ^ PEER.checksum(&package[..length - 3]))
            });
        });
        group.bench_function("crc crate by 16, check alone, each package", |bencher| {
            let length = line.len() / PACKAGES;
            bencher.iter(|| {
                let packages = black_box(&line).chunks_exact(length);
                packages.fold(0, |sum, package| sum ^ PEER_BY_16.checksum(&package[..length - 3]))
            });
        });
        group.finish();
    }
}

criterion_group!(benches, decode);
criterion_main!(benches);

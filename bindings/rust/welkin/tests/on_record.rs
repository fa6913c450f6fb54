//! Results have the bits that C++ has on record, and errors the library's messages.
use welkin::{Cubemap, SkyTableOptions, SkyTables, Worker};

fn recorded(name: &str, values: impl Iterator<Item = f64>) {
    let hash = values.flat_map(|value| value.to_ne_bytes()).fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
    });
    let record = include_str!("../../../../tests/portability/core_hashes.txt");
    let line = format!("{name} {hash:016x}");
    assert!(record.lines().any(|other| other == line), "not on record: {line}");
}

/// The cubemap of tests/portability/hashing.h.
fn cubemap(size: usize, seed: u64) -> Cubemap {
    let mut state = seed * 2 + 1;
    let mut bits = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as u32
    };
    let pixels = (0..18 * size * size).map(|_| {
        let unit = (bits() & 0xFF_FFFF) as f32 / 16777216.0;
        if bits() % 509 == 0 { unit * 700.0 } else { unit }
    });
    Cubemap::new(size, pixels.collect()).unwrap()
}

#[test]
fn results_have_the_recorded_bits() {
    let light = cubemap(64, 1).project(3).unwrap();
    recorded("project/cubemap_64_bands_3", light.coefficients.into_iter().flatten());
    let worker = Worker::new(1).unwrap();
    let bake = worker.bake(cubemap(64, 10), 64).unwrap().wait().unwrap();
    for chain in [bake.specular().unwrap(), cubemap(64, 10).prefilter(64).unwrap()] {
        let faces = (0..chain.levels()).flat_map(|level| (0..6).map(move |face| (level, face)));
        let texels = faces.flat_map(|(level, face)| chain.face(level, face).unwrap().iter().map(|v| f64::from(*v)));
        recorded("prefilter/cubemap_64", texels);
    }
    let options = SkyTableOptions {
        heights: 5, view_zeniths: 16, sun_zeniths: 16, sun_angles: 4, transmittance_heights: 16,
        transmittance_zeniths: 64, irradiance_heights: 4, irradiance_sun_zeniths: 16, orders: 3,
        ..SkyTableOptions::default()
    };
    let curve = SkyTables::new(0, &options).unwrap().curve(200.0, 32).unwrap();
    let (light, sun) = curve.at(10.0, 30.0).unwrap();
    recorded("sky/curve", light.into_iter().flatten().chain(sun));
}

#[test]
fn errors_have_messages() {
    assert!(cubemap(2, 1).project(17).unwrap_err().message.contains("17"));
    assert!(Cubemap::new(2, vec![0.0; 71]).is_err());
    assert!(cubemap(2, 1).prefilter(2).unwrap().face(9, 0).is_err());
}

//! Results have the bits that C++ has on record (tests/portability/core_hashes.txt).
use std::mem::{size_of, zeroed};
use std::os::raw::c_void;
use std::ptr::null;
use welkin_sys::*;

/// FNV-1a over the bytes of doubles.
fn hash(values: &[f64]) -> u64 {
    values.iter().flat_map(|value| value.to_ne_bytes()).fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
    })
}

/// The numbers of `radiances` in tests/portability/hashing.h.
fn radiances(count: usize, seed: u64) -> Vec<f32> {
    let mut state = seed * 2 + 1;
    let mut bits = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as u32
    };
    (0..count)
        .map(|_| {
            let unit = (bits() & 0xFF_FFFF) as f32 / 16777216.0;
            if bits() % 509 == 0 { unit * 700.0 } else { unit }
        })
        .collect()
}

#[test]
fn a_projection_has_the_recorded_bits() {
    let record = include_str!("../../../../tests/portability/core_hashes.txt");
    for size in [7usize, 64, 257] {
        let pixels = radiances(18 * size * size, 1);
        unsafe {
            let mut cubemap: welkin_environment = zeroed();
            cubemap.struct_size = size_of::<welkin_environment>() as u32;
            cubemap.format = WELKIN_FORMAT_RGB_F32;
            cubemap.size = size as i64;
            for (k, face) in pixels.chunks(3 * size * size).enumerate() {
                cubemap.faces[k] = face.as_ptr() as *const c_void;
            }
            let mut light: welkin_projection = zeroed();
            light.struct_size = size_of::<welkin_projection>() as u32;
            assert_eq!(welkin_project(&cubemap, 1, null(), null(), &mut light), WELKIN_OK);
            let line = format!("project/cubemap_{size}_bands_3 {:016x}", hash(&light.coefficients[..27]));
            assert!(record.lines().any(|recorded| recorded == line), "not on record: {line}");
        }
    }
}

#[test]
fn the_library_has_the_version_of_the_header() {
    assert_eq!(unsafe { welkin_c_version() }, WELKIN_C_VERSION);
}

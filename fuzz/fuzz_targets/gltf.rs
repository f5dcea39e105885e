#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    clench_fuzz::gltf(data);
});

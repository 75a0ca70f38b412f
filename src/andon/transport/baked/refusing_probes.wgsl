// As refusing.wgsl, and those that have the same light from probes.

const REFUSING: u32 = 3u;

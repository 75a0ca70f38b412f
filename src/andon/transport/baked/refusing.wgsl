// Virtual objects that take no baked light, by taking.wgsl: here those that lamps do not light. In
// refusing_probes.wgsl those that probes light as well.

const REFUSING: u32 = 1u;

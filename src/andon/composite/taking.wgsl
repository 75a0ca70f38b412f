// Which light a virtual object does not take as all others do: in `emitted`, beside what its
// materials emit. Luminous bodies have no such row.

//!import andon/gbuffer/gbuffer.wgsl

const NO_LAMPS: u32 = 1u;
const PROBES: u32 = 2u;

fn taking(point: SurfacePoint) -> u32 {
  let material = min((point.flags >> MATERIAL_SHIFT) & 0xffffu, 4095u);
  let own = (point.flags & OBJECT) != 0u && (point.flags >> BODY_SHIFT) == 0u;
  return select(0u, u32(emitted[material].w), own);
}

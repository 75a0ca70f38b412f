// No probes. The stage exchanges this module for one with the numbers of its volume: where in the
// pictures of numbers what begins, and how many there are (records.py).

const PROBE_CELLS: i32 = 0;
const PROBE_FACETS: i32 = 0;
const PROBE_RINGS: i32 = 0;
const PROBE_STARTS: i32 = 0;
const PROBE_PLACES: i32 = 0;
const PROBE_ZONES: i32 = 0;
const PROBE_BOXES: i32 = 0;
const PROBE_BOX_COUNT: i32 = 1;
const PROBE_CELL_STEPS: i32 = 1;
const PROBE_FACET_STEPS: i32 = 1;
const PROBE_TERMS: i32 = 7;
const PROBE_SIDE: f32 = 16.0;
const PROBE_TILES: i32 = 1;
const PROBE_FAR_M: f32 = 1.0;

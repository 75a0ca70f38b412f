// Constants of the tables, as records.py writes them.

const EDGE: f32 = 32.0;
const LAST_COLUMN: f32 = 223.0;
const FAR_COLUMNS: f32 = 40.0;
const ROWS: f32 = 128.0;
const EDGES: f32 = 1024.0;
const HALO_LAST: f32 = 511.0;

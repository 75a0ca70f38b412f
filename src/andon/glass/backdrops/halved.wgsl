// Where the finer level lies in the texture, and its last column and row; buffers.py writes them.

const CORNER = vec2i(0, 0);
const LAST = vec2i(639, 359);

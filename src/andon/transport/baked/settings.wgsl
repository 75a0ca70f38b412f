// No maps. The stage exchanges this module for one with the numbers of its light (records.py):
// which projections its maps have, how they are mixed, how many lamps there are.

const BAKED_PINHOLE: bool = true;
const BAKED_FISHEYE: bool = true;
const BAKED_LATLONG: bool = true;
const BAKED_FIRST_VALID: bool = false;
const BAKED_LAMPS: i32 = 1;

// Numbers of constants of three, which is not in scope.

export const FLOAT = 1015, HALF_FLOAT = 1016, RGBA = 1023;
export const NEAREST = 1003, LINEAR = 1006, REPEAT = 1000, CLAMP = 1001;
export const BLURRED_CUBE = 306; // mapping: CubeUVReflectionMapping
export const BOTH_SIDES = 2;

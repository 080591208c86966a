// What app/render/scripts.py makes of constants that Python and JavaScript share.

export const WATER_UNIFORMS: string[];
export const RAIN_UNIFORMS: string[];
export const MAX_WATERLINES: number;
export const DARK_LIFT: number;
export const LUMA: number[];

// Water and sky in GLSL: groups of functions, and the fragment shaders made of them. Used by water.js and rain.js.
//
// The uniforms are named in `WATER_UNIFORMS` (app/render/material.py), which also says how each is filled. Directions
// and positions are those of the sea's node, z up; "world" is three's own frame. DETAILS (quality.js): 2 all, 1 less,
// 0 least. What is not shown makes the water rough instead, so that its light stays the same.

import { MAX_WATERLINES } from "../shared.js";

// The table of the sky: SKY_ROWS elevations at each of these blurs, the same of the sky as it is seen, then the haze at the
// horizon, its mean and that of the sky.
export const SKY_BLUR = [0.08, 0.2, 0.33, 0.55, 0.8], SKY_ROWS = 64, SKY_COLUMNS = 256;
export const SKY_TABLE = `
  #define SKY_TABLE
  #define SKY_ROWS ${SKY_ROWS}
  #define SKY_BLURS ${SKY_BLUR.length}
  #define SKY_HEIGHT ${(SKY_BLUR.length + 1) * SKY_ROWS + 3}
  const float[SKY_BLURS] SKY_BLUR = float[](${SKY_BLUR.map((blur) => blur.toFixed(2))});`;

export const WATER_GLSL = {
  // The waves of a periodic tile, as textures. Near the eye the sea is that tile, which the simulation moves. Farther
  // away than a tile is long it is made of pieces of the tile that lie at random places, as a tile that repeats is seen
  // from above. Pieces are blended so that the variance of heights and slopes stays the same (Heitz and Neyret 2018,
  // Proc. ACM Comput. Graph. Interact. Tech. 1(2):31, eq. 3), and so does their spectrum within a piece.
  waves: `
    uniform highp sampler2D wavePlaces; // displacement [m] of the tile's vertices from where they rest
    uniform highp sampler2D waveSlopes; // slope x, slope y, foam, sum of the squares of the slopes
    uniform vec3 grid; // rows and columns of vertices, side of the tile or radius of the last ring [m]
    uniform vec3 ringLaw; // rings: exponent of their radii (0: geometric), radius of the first [m], ratio of their steps
    uniform vec3 gridMiddle; // x, y [m] of the middle of the rings, unused
    uniform vec3 shown; // 1 if the sky is drawn, 1 if the lines of the grid are, unused
    uniform vec3 gaugePlace; // x, y [m] around which the sea is the tile however far it is, and whether there is such a place
    const float PIECE = 0.7; // side of the triangles that pieces are blended on, in sides of the tile

    // Share of the sea at x that is made of pieces: 0 up to half a tile from the eye and near the wave gauge, 1 beyond a
    // tile.
    float pieceShare(vec2 x, vec3 eye) {
      float near = gaugePlace.z * (1.0 - smoothstep(0.1, 0.4, distance(x, gaugePlace.xy) / grid.z));
      return (1.0 - near) * smoothstep(0.5, 1.0, distance(vec3(x, 0.0), eye) / grid.z);
    }

    // The corners of the triangle around x, and its weight at each; a piece belongs to each corner.
    vec3 cornersAround(vec2 x, out vec2 a, out vec2 b, out vec2 c) {
      vec2 p = x / (PIECE * grid.z);
      p = vec2(p.x - 0.57735027 * p.y, 1.15470054 * p.y);
      vec2 i = floor(p), f = p - i;
      bool upper = f.x + f.y > 1.0;
      a = upper ? i + 1.0 : i;
      b = i + (upper ? vec2(0.0, 1.0) : vec2(1.0, 0.0));
      c = i + (upper ? vec2(1.0, 0.0) : vec2(0.0, 1.0));
      vec3 w = upper ? vec3(f.x + f.y - 1.0, 1.0 - f.x, 1.0 - f.y) : vec3(1.0 - f.x - f.y, f);
      return w * w * w / dot(w * w, w);
    }

    // Value of a texture of the tile at x [m], as a mean over texels of 2^level cells.
    vec4 tileAt(sampler2D tile, vec2 x, float level) {
      return textureLod(tile, x.yx / grid.z + 0.5 / (grid.yx - 1.0), level);
    }

    // A texture of the tile at x; share: of pieces. Displacements and slopes keep their variance about the mean height of
    // the tile's vertices; foam (isSlope), which is no sum of waves, keeps its mean. The last number of the slopes is made
    // the variance that they lack.
    vec4 wavesAt(sampler2D tile, vec2 x, float share, float level, bool isSlope) {
      vec4 sum = vec4(0.0);
      float foam = 0.0, mean = isSlope || share == 0.0 ? 0.0 : tileAt(tile, x, 16.0).z; // the coarsest level
      vec2 corner[3];
      vec3 weight = share > 0.0 ? cornersAround(x, corner[0], corner[1], corner[2]) : vec3(0.0);
      float unit = share > 0.0 ? inversesqrt(dot(weight, weight)) : 0.0;
      for (int k = 0; k < 4; k++) {
        float part = k < 3 ? share * weight[k] : 1.0 - share, w = k < 3 ? unit * part : part;
        if (part <= 0.001) continue;
        vec4 wave = tileAt(tile, k < 3 ? x + grid.z * hash2(corner[k]) : x, level);
        if (isSlope) wave.w = max(wave.w - dot(wave.xy, wave.xy), 0.0);
        sum += vec4(w * wave.xy, w * (wave.z - mean), w * w * wave.w);
        foam += part * wave.z;
      }
      float norm = inversesqrt(1.0 - 2.0 * share * (1.0 - share));
      return vec4(norm * sum.xy, isSlope ? foam : mean + norm * sum.z, norm * norm * sum.w);
    }

    // The number of the ring at a distance [m] from the middle of the rings, which is ring 0.
    float ringAt(float r) {
      if (ringLaw.x > 0.0) return pow(r / ringLaw.y, 1.0 / ringLaw.x);
      return ringLaw.z > 1.0001 ? log(1.0 + r * (ringLaw.z - 1.0) / ringLaw.y) / log(ringLaw.z) : r / ringLaw.y;
    }

    // Value of a texture of rings, a row each, at x [m]. Rings of even number are turned by half a spoke.
    vec4 ringsAt(sampler2D rings, vec2 x) {
      vec2 p = x - gridMiddle.xy;
      float ring = min(ringAt(length(p)), grid.x - 1.001), low = floor(ring), turned = 0.5 / grid.y * (1.0 - mod(low, 2.0));
      float turn = atan(p.y, p.x + 1e-9) / 6.2831853 + 0.5 / grid.y;
      vec4 inner = textureLod(rings, vec2(turn - turned, (low + 0.5) / grid.x), 0.0);
      vec4 outer = textureLod(rings, vec2(turn + turned - 0.5 / grid.y, (low + 1.5) / grid.x), 0.0);
      return mix(inner, outer, ring - low);
    }

    // Flatness of a sea of rings at x: 1 from the last ring on.
    float ringFlatness(vec2 x) { return smoothstep(0.8, 1.0, distance(x, gridMiddle.xy) / grid.z); }`,


  // One function for the sky that is seen and the sky that is mirrored, so that sea and sky meet without a line.
  sky: `
    #include <cube_uv_reflection_fragment>
    #include <envmap_common_pars_fragment>
    uniform mat4 fromSea;
    uniform vec3 skyline; // height of the land towards the sun and away from it [rad], stretch at the horizon
    uniform vec3 skyFold; // share of the photograph's azimuths in use, blur of the haze, radiance reduced to its half
    uniform vec3 sunDirection; // towards the sun, of length 1
    uniform vec3 sunLight; // irradiance
    uniform vec3 skyTint; // colour filter on the photograph
    uniform vec3 skyLow; // its mean radiance at the horizon
    uniform vec3 skyHigh; // and overhead
    uniform vec3 clouds; // cover, size of a cloud, share of its light that thick cloud takes away
    uniform vec3 wind; // direction of ripples, foam and clouds [rad], gravity [m/s2], size of a patch of foam [m]
    uniform vec3 lens; // haze distance [m], exposure, share of the sun's disc and glitter that is visible
    uniform vec3 seaState; // time [s], significant height [m], mean square slope of the mesh

    // The photographs were taken on land. Their elevations are remapped so that the land lies below the drawn horizon.
    // Where trees or houses stand around, only the azimuths near the sun are used, and spread over the circle.
    float sunBearing() { return atan(sunDirection.y, sunDirection.x + 1e-6); }

    // The direction in the photograph that is drawn at the direction d; side: 1, or -1 for its mirror image.
    vec3 photographDirection(vec3 d, float side) {
      float bearing = atan(d.y, d.x) - sunBearing();
      bearing = mod(bearing + 3.14159265, 6.2831853) - 3.14159265;
      float land = mix(skyline.x, skyline.y, 0.5 - 0.5 * cos(bearing));
      float e = asin(clamp(d.z, 0.0, 1.0)) / 1.5707963;
      float g = skyline.z, l = land / 1.5707963;
      e = 1.5707963 * (l + e * (g + (1.0 - l - g) * e));
      float a = bearing * skyFold.x * side + sunBearing();
      return vec3(cos(e) * cos(a), cos(e) * sin(a), sin(e));
    }

    // Radiance of the photograph in its direction d; blur: 0 sharp to 1.
    vec3 photograph(vec3 d, float blur) {
      #if defined(USE_ENVMAP) && defined(ENVMAP_TYPE_CUBE_UV)
        vec3 c = textureCubeUV(envMap, envMapRotation * (mat3(fromSea) * d), blur).rgb;
        float gain = envMapIntensity;
      #else
        vec3 c = mix(skyLow, skyHigh, sqrt(max(d.z, 0.0))); // as in scene/formula_sky.js
        float gain = 1.0;
      #endif
      // Bright places keep their hue. The sun's disc is drawn separately, as the photograph is blurred.
      float light = dot(c, vec3(0.3, 0.5, 0.2));
      c = max(mix(vec3(light), c, 1.15), 0.0) * pow(skyTint, vec3(0.7 + 2.0 * clamp(d.z, 0.0, 0.6)));
      return c / (1.0 + light / skyFold.z) * gain;
    }

    // Noise of several octaves with the shapes of clouds, about -1 to 1.
    float cloudNoise(vec2 p, int octaves) {
      vec2 drift = vec2(gradientNoise(p * 0.6 + 4.0).x, gradientNoise(p * 0.6 - 9.0).x);
      p += 0.7 * drift;
      float n = 0.0, size = 1.0;
      for (int k = 0; k < octaves; k++) {
        n += size * gradientNoise(p).x;
        p = mat2(1.6, 1.2, -1.2, 1.6) * p + 3.7;
        size *= 0.52;
      }
      return n;
    }

    // A layer of cloud in front of the photograph. The last number of the result is the share of the sky it hides.
    // isMirrored: it has no relief; with a literal here, the compiler leaves out what is not used.
    vec4 addClouds(vec3 c, vec3 d, float blur, vec3 ambient, bool isMirrored) {
      if (clouds.x <= 0.0 || d.z < 0.004) return vec4(c, 0.0);
      vec2 w = vec2(cos(wind.x), sin(wind.x));
      vec2 p = d.xy / (d.z + 0.11);
      p = vec2(dot(p, w) * 0.55 - 0.004 * seaState.x, dot(p, vec2(-w.y, w.x))) / clouds.y;
      int octaves = (isMirrored ? 1 : 4) + DETAILS;
      float n = cloudNoise(p, octaves) + 1.3 * (clouds.x - 0.5);
      float cover = smoothstep(-0.12 - blur, 0.55 + blur, n);
      vec2 s = normalize(sunDirection.xy + 1e-4);
      if (cover <= 0.003) return vec4(c, 0.0);
      float lit = 0.6;
      if (!isMirrored) {
        float sunward = cloudNoise(p + 0.22 * vec2(dot(s, w), dot(s, vec2(-w.y, w.x))), 3);
        lit = clamp(0.55 + 1.4 * (n - 1.3 * (clouds.x - 0.5) - sunward), 0.15, 1.2);
      }
      float near = max(dot(d, sunDirection), 0.0);
      vec3 glow = sunLight * (0.05 + 0.10 * lit + 0.5 * pow(near, 24.0) * (1.2 - cover) + 0.12 * pow(near, 3.0) * lit);
      // Thick cloud is darker from below than thin cloud.
      float thick = 1.0 - clouds.z * smoothstep(-0.5, 0.45, n - 1.3 * (clouds.x - 0.5));
      vec3 cloud = (ambient * (0.55 + 0.45 * lit) + glow) * thick;
      return vec4(mix(c, cloud, cover * 0.92 * smoothstep(0.0, 0.09, d.z)), cover);
    }

    // Radiance of the photograph as it is drawn in the direction d.
    vec3 drawnPhotograph(vec3 d, float blur) {
      vec3 c = photograph(photographDirection(d, 1.0), blur);
      // Opposite to the sun the two ends of the spread photograph meet. There each is blended with its mirror image.
      if (skyFold.x < 1.0) {
        vec2 s = normalize(sunDirection.xy + 1e-6), l = d.xy / max(length(d.xy), 1e-4);
        float back = smoothstep(0.3, 1.0, -dot(s, l));
        if (back > 0.0) c = mix(c, photograph(photographDirection(d, -1.0), blur), 0.5 * back);
      }
      return c;
    }

    uniform vec3 rainVeil; // extinction of light by rain [1/m], height from which it falls [m], unused
    vec3 levelOf(vec3 d) { return vec3(d.xy / max(length(d.xy), 1e-4), 0.0); }

    // The colours of the photographs come in blocks of some degrees: take the brightness sharp and the hue blurred.
    vec3 withEvenHue(vec3 sharp, vec3 soft) {
      vec3 w = vec3(0.3, 0.5, 0.2);
      float light = dot(sharp, w), even = dot(soft, w);
      float detail = 0.6 * smoothstep(0.15, 0.5, abs(light - even) / even);
      return mix(soft * (light / even), sharp, detail);
    }

    // sky: radiance of the sky without clouds in the direction d. ambientLight: its mean. horizon: of the haze in the
    // direction d. meanHorizon: the mean of both sides, which is scattered where the direction is steep, and lights from
    // around. clearSky: the sky as it is seen. With a table (sky_table.js) they are looked up in it.
    #if defined(SKY_TABLE) && defined(USE_ENVMAP)
      uniform highp sampler2D skyTable;
      vec3 skyRow(vec3 d, float row) {
        return textureLod(skyTable, vec2(atan(d.y, d.x + 1e-9) / 6.2831853, (row + 0.5) / float(SKY_HEIGHT)), 0.0).rgb;
      }
      float skyElevation(vec3 d) { return sqrt(asin(clamp(d.z, 0.0, 1.0)) / 1.5707963) * float(SKY_ROWS - 1); }
      vec3 sky(vec3 d, float blur) {
        float row = skyElevation(d), block = 0.0;
        for (int k = 1; k < SKY_BLURS; k++) block += clamp((blur - SKY_BLUR[k - 1]) / (SKY_BLUR[k] - SKY_BLUR[k - 1]), 0.0, 1.0);
        float low = min(floor(block), float(SKY_BLURS - 2));
        vec3 sharp = skyRow(d, low * float(SKY_ROWS) + row), soft = skyRow(d, (low + 1.0) * float(SKY_ROWS) + row);
        return mix(sharp, soft, block - low);
      }
      vec3 clearSky(vec3 d) { return skyRow(d, float(SKY_BLURS * SKY_ROWS) + skyElevation(d)); }
      vec3 horizon(vec3 d) { return skyRow(d, float(SKY_HEIGHT - 3)); }
      vec3 meanHorizon() { return texelFetch(skyTable, ivec2(0, SKY_HEIGHT - 2), 0).rgb; }
      vec3 ambientLight() { return texelFetch(skyTable, ivec2(0, SKY_HEIGHT - 1), 0).rgb; }
    #else
      vec3 sky(vec3 d, float blur) { return drawnPhotograph(d, blur); }
      vec3 ambientLight() { return photograph(vec3(0.0, 0.0, 1.0), 1.0); }
      vec3 horizon(vec3 d) { return sky(levelOf(d), skyFold.y); }
      vec3 meanHorizon() { return 0.5 * (horizon(sunDirection) + horizon(-sunDirection)); }
      vec3 clearSky(vec3 d) { return withEvenHue(sky(d, 0.08), sky(d, 0.33)); }
    #endif

    // The glow of the air around the sun, at a distance from its direction.
    float sunGlow(float off) { return 0.30 * exp(-off * 16.0) + 0.07 * exp(-off * 4.0) + 2.4 * lens.z * exp(-off * 60.0); }

    // Radiance at the horizon in the direction d, which sea and sky have in common there.
    vec3 horizonGlow(vec3 d) {
      return horizon(d) + sunLight * sunGlow(length(levelOf(d) - sunDirection));
    }

    // Radiance c of the sky in the direction d as it is seen through the rain.
    vec3 behindRain(vec3 c, vec3 d) {
      if (rainVeil.x <= 0.0) return c;
      // It falls in shafts, aslant.
      float bearing = atan(d.y, d.x) + d.z, shafts = 1.0 + 0.4 * sin(7.0 * bearing + 1.9 * sin(4.0 * bearing));
      return mix(horizon(d), c, exp(-shafts * rainVeil.x * rainVeil.y / max(d.z, 0.02)));
    }`,

  noise: `
    #include <common>
    // Two random numbers in 0..1 for each whole-numbered p.
    vec2 hash2(vec2 p) {
      uvec2 q = uvec2(ivec2(p)) * uvec2(1597334673u, 3812015801u);
      uint n = (q.x ^ q.y) * 1597334673u;
      return vec2(n & 0xffffu, n >> 16) / 65535.0;
    }
    // Gradient noise and its two derivatives at p.
    vec3 gradientNoise(vec2 p) {
      vec2 i = floor(p), f = p - i;
      vec2 u = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
      vec2 du = 30.0 * f * f * (f * (f - 2.0) + 1.0);
      vec2 ga = hash2(i) * 2.0 - 1.0, gb = hash2(i + vec2(1, 0)) * 2.0 - 1.0;
      vec2 gc = hash2(i + vec2(0, 1)) * 2.0 - 1.0, gd = hash2(i + vec2(1, 1)) * 2.0 - 1.0;
      float a = dot(ga, f), b = dot(gb, f - vec2(1, 0)), c = dot(gc, f - vec2(0, 1)), d = dot(gd, f - vec2(1, 1));
      float v = a + u.x * (b - a) + u.y * (c - a) + u.x * u.y * (a - b - c + d);
      vec2 g = ga + u.x * (gb - ga) + u.y * (gc - ga) + u.x * u.y * (ga - gb - gc + gd)
             + du * (u.yx * (a - b - c + d) + vec2(b, c) - a);
      return vec3(v, g);
    }`,

  surface: `
    uniform vec3 deepColor;
    uniform vec3 scatterColor;
    uniform vec3 foamColor;
    uniform vec3 optics; // refractive index, roughness (rms slope), factor on reflections
    uniform vec3 ripple; // rms slope, longest and shortest ripple [m]

    // Fresnel reflectance of unpolarised light at the cosine c on a fluid of index n.
    float fresnel(float c, float n) {
      float g = sqrt(n * n - 1.0 + c * c), p = (g - c) / (g + c), q = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
      return 0.5 * p * p * (1.0 + q * q);
    }

    // Reflection of a rough sea, seen at the cosine c of the angle to its normal: (reflectance, mean slope of the facets
    // that mirror, towards the eye). The slopes are Gaussian with this rms along each axis (Cox and Munk 1954), and
    // count by how much of them the eye sees. Gauss and Legendre's sum over the visible slopes along the view.
    const float FACET_LIMIT = 3.2; // rms slopes beyond which no facet is counted
    const vec3 FACET_NODES = vec3(0.238619186, 0.661209386, 0.932469514);
    const vec3 FACET_WEIGHTS = vec3(0.467913935, 0.360761573, 0.171324492);
    vec2 roughMirror(float c, float rms, float n) {
      float level = sqrt(1.0 - c * c);
      float low = -FACET_LIMIT, high = min(c / max(level * rms, 1e-6), FACET_LIMIT);
      vec3 sum = vec3(0.0); // of weight, weight times reflectance, the same times slope
      for (int k = 0; k < 6; k++) {
        float node = FACET_NODES[k % 3] * (k < 3 ? 1.0 : -1.0);
        float t = 0.5 * (high - low) * node + 0.5 * (high + low), slope = rms * t;
        float seen = max(c - slope * level, 0.0);
        float weight = FACET_WEIGHTS[k % 3] * exp(-0.5 * t * t) * seen;
        float mirrored = weight * fresnel(min(seen / sqrt(1.0 + slope * slope + rms * rms), 1.0), n);
        sum += vec3(weight, mirrored, -mirrored * slope);
      }
      return vec2(sum.y / sum.x, sum.z / max(sum.y, 1e-9));
    }

    const float NOISE_VARIANCE = 0.0310; // of gradientNoise
    const float NOISE_SLOPE_VARIANCE = 0.2588; // of each of its derivatives
    const float GUST_MEAN = 0.65;
    const float GUST_CONTRAST = 0.5;
    const float CREST = 0.6; // length of a crest along the wind over that across it

    // Slopes of ripples that are too short for the mesh: (slope x, slope y, variance not shown, gust). Each octave has
    // the same variance, as in the equilibrium range of wind waves. An octave that is finer than a pixel is not shown;
    // its variance is returned instead, so that both together are always the square of ripple.x. Phase speeds are
    // those of deep water.
    vec4 ripples(vec2 x, float footprint) {
      vec2 slope = vec2(0.0);
      float lost = 0.0, wave = ripple.y, angle = wind.x;
      float octaves = clamp(1.0 + floor(log(ripple.y / ripple.z) / 0.755), 1.0, 9.0);
      float each = ripple.x * ripple.x / octaves;
      float gain = sqrt(each / (NOISE_SLOPE_VARIANCE * (1.0 + CREST * CREST)));
      // Gusts make patches of rougher and smoother water; they do not repeat from tile to tile.
      vec2 patches = 1.0 - smoothstep(0.1, 0.5, footprint / (ripple.y * vec2(24.0, 7.0)));
      float gust = GUST_MEAN + GUST_CONTRAST * (patches.x * gradientNoise(x / (ripple.y * 24.0) + seaState.x * 0.02).x
                                              + patches.y * gradientNoise(x / (ripple.y * 7.0) - seaState.x * 0.03).x);
      float power = GUST_MEAN * GUST_MEAN + GUST_CONTRAST * GUST_CONTRAST * NOISE_VARIANCE * dot(patches, patches);
      gust = max(gust, 0.15) / sqrt(power);
      const int SHOWN = min(4 * DETAILS + 1, 9);
      for (int k = 0; k < SHOWN; k++) {
        if (float(k) >= octaves) break;
        float seen = 1.0 - smoothstep(0.12, 0.5, footprint / wave);
        lost += each * (1.0 - seen * seen);
        if (seen > 0.0) {
          vec2 d = vec2(cos(angle), sin(angle));
          float speed = sqrt(wind.y * wave / 6.2832);
          // Crests are longer across the wind than along it.
          vec2 along = vec2(dot(x, d) - speed * seaState.x, CREST * dot(x, vec2(-d.y, d.x)));
          vec3 n = gradientNoise(along / wave);
          slope += seen * gain * (n.y * d + CREST * n.z * vec2(-d.y, d.x));
        }
        wave *= 0.47;
        angle += (mod(float(k), 2.0) < 0.5 ? 0.9 : -1.3);
      }
      lost += each * max(octaves - float(SHOWN), 0.0);
      return vec4(slope * gust, lost * gust * gust, gust);
    }

    // Distance from the walls between cells around random points: 0 on a wall, up to about 0.5 inside a cell.
    float cellWalls(vec2 p) {
      vec2 i = floor(p), f = p - i;
      float first = 8.0, second = 8.0;
      for (int a = -1; a <= 1; a++) for (int b = -1; b <= 1; b++) {
        vec2 o = vec2(a, b);
        vec2 r = o + hash2(i + o) - f;
        float d = dot(r, r);
        second = min(second, max(first, d));
        first = min(first, d);
      }
      return sqrt(second) - sqrt(first);
    }

    // The pattern of foam by places that move with the water: walls between bubbles of two sizes, and grain. Its share
    // of the sea below v is 1/(1 + exp(-(FOAM_0 + FOAM_1 v + FOAM_2 v^2 + FOAM_3 v^3))), fitted to 4e5 points.
    const float FOAM_MEAN = 0.377;
    const float FOAM_VARIANCE = 0.0578;
    const float FOAM_COARSE_VARIANCE = 0.0498;
    const float FOAM_SMALL_MEAN = 0.269;
    const float FOAM_0 = -3.223;
    const float FOAM_1 = 12.881;
    const float FOAM_2 = -13.562;
    const float FOAM_3 = 8.750;

    // Foam where the simulation has a share of it: (cover, slope x, slope y of its bubbles, shade). The mean cover
    // is the share: where pixels are too wide for the pattern, it is the cover. Fresh foam is sharp, old foam is soft.
    vec4 foamCover(vec2 x, float share, float footprint) {
      if (share <= 0.004) return vec4(0.0);
      vec2 d = vec2(cos(wind.x), sin(wind.x));
      vec2 p = vec2(dot(x, d) * 0.7, dot(x, vec2(-d.y, d.x))) / wind.z;
      float seen = 1.0 - smoothstep(0.3, 0.9, footprint / wind.z); // at all qualities: white water is the last to go
      float near = DETAILS > 1 ? 1.0 - smoothstep(0.06, 0.2, footprint / wind.z) : 0.0;
      float cover = share, grain = 0.0;
      vec2 relief = vec2(0.0);
      if (seen > 0.0) {
        p += 1.1 * vec2(gradientNoise(p * 0.43 + 3.1).x, gradientNoise(p * 0.43 - 7.7).x);
        vec2 q = p + 0.30 * vec2(gradientNoise(p * 2.3).x, gradientNoise(p * 2.3 + 9.0).x);
        float v = cellWalls(q * 1.4) - 0.55 * gradientNoise(p * 0.5 + 11.0).x + 0.4 * FOAM_SMALL_MEAN;
        float variance = FOAM_COARSE_VARIANCE;
        if (near > 0.0) {
          float small = cellWalls(q * 4.7) - FOAM_SMALL_MEAN;
          vec3 bubbles = gradientNoise(p * 13.0);
          float fine = 0.4 * small + 0.22 * bubbles.x;
          v += near * fine;
          variance += near * near * (FOAM_VARIANCE - FOAM_COARSE_VARIANCE);
          relief = near * 0.5 * (bubbles.y * d + bubbles.z * vec2(-d.y, d.x));
          grain = near * (bubbles.x - 0.8 * small);
        }
        v = FOAM_MEAN + (v - FOAM_MEAN) * sqrt(FOAM_VARIANCE / variance);
        float below = 1.0 / (1.0 + exp(-(FOAM_0 + v * (FOAM_1 + v * (FOAM_2 + v * FOAM_3)))));
        // As wide an edge on either side leaves the mean as it is.
        float soft = min(mix(0.16, 0.05, share), 0.9 * min(share, 1.0 - share)) + 1e-4;
        cover = mix(share, smoothstep(-soft, soft, share - below), seen);
      }
      return vec4(cover, relief, 1.0 + 0.35 * grain);
    }

    // Rings and jets of raindrops. A small drop makes a ring of the waves of least speed. A large one moves more water: its
    // ring is of the waves of least group speed, the last to leave its place, whose crests run through the ring. A ring lives
    // until it is RING_REACH of its wavelengths wide. In each layer the sea has cells of RING_CELL wavelengths with one ring at
    // a time.
    uniform vec3 rainRings; // drops that make a ring [1/(m2 s)] (0: no rain), least wavelength [m] and speed [m/s] of rings
    const float LARGE_SHARE = 0.05; // of these drops
    const vec2 RING_LENGTH = vec2(1.0, 2.54), RING_SPEED = vec2(1.0, 0.77); // of both kinds: Lamb, Art. 267
    const vec2 CREST_SPEED = vec2(1.0, 1.574); // over that of the ring
    const float RING_CELL = 10.0;
    const float RING_REACH = 3.0;
    const float RING_SLOPE = 0.7; // greatest, of the first wave of a large drop
    const float RING_VARIANCE = 0.00248; // of both slopes together, of a layer where every cell has a ring
    const float RING_GAIN = 2.0; // greatest factor on slopes where there are more rings than cells
    // Of the jet that each drop throws up: its time [s], height and radius, in wavelengths of its ring.
    const vec2 JET_TIME = vec2(0.12, 0.2), JET_HEIGHT = vec2(2.0, 1.5), JET_RADIUS = vec2(0.35, 0.25);

    // Slopes of the rings, and jets: (slope x, slope y, variance not shown, share of the view that is jets). lean: of the view,
    // its way along the level over that down.
    vec4 rainSlopes(vec2 x, float footprint, vec2 lean) {
      if (rainRings.x <= 0.0) return vec4(0.0);
      vec2 waves = RING_LENGTH * rainRings.y, lives = RING_REACH * waves / (RING_SPEED * rainRings.z), sides = RING_CELL * waves;
      vec2 fluxes = rainRings.x * vec2(1.0 - LARGE_SHARE, LARGE_SHARE);
      // Layers of both kinds, rings in each cell, and the share of the cells that have one.
      ivec2 layers = DETAILS > 1 ? ivec2(2, 3) : ivec2(1, 1 + DETAILS);
      vec2 rings = fluxes * lives * sides * sides / vec2(layers), shares = min(rings, 1.0);
      vec2 gains = min(sqrt(max(rings, 1.0)), RING_GAIN), pixels = footprint / waves;
      vec2 seen = 1.0 - smoothstep(0.15, 0.6, pixels), jetsSeen = 1.0 - smoothstep(0.7, 2.0, pixels);
      vec2 slope = vec2(0.0), missing = 1.0 - seen * seen;
      float jets = 0.0;
      for (int k = 0; k < layers.x + layers.y; k++) {
        int kind = k < layers.y ? 1 : 0;
        if (jetsSeen[kind] <= 0.0) continue;
        mat2 turned = mat2(cos(0.7 * float(k)), sin(0.7 * float(k)), -sin(0.7 * float(k)), cos(0.7 * float(k)));
        vec2 p = turned * x / sides[kind] + 0.37 * float(k);
        vec2 i = floor(p), layer = vec2(101.0, 57.0) * float(k);
        float turn = seaState.x / lives[kind] + hash2(i + layer).x, number = floor(turn), age = turn - number;
        vec2 place = hash2(i + layer + number * vec2(17.0, 29.0));
        vec2 drop = hash2(i - layer - number * vec2(23.0, 13.0));
        if (drop.x >= shares[kind]) continue;
        vec2 d = RING_CELL * (p - i) - (RING_REACH + 1.0) - (RING_CELL - 2.0 * RING_REACH - 2.0) * place;
        float r = length(d), w = r - RING_REACH * age;
        if (abs(w) < 1.0) {
          float fade = (1.0 - w * w) * (1.0 - w * w), strength = mix(0.4, 1.0, drop.y * drop.y) * (1.0 - age * age);
          float crest = sin(6.2832 * (r - CREST_SPEED[kind] * RING_REACH * age));
          slope += seen[kind] * gains[kind] * RING_SLOPE * strength * fade * crest * d * turned / max(r, 1e-3);
        }
        // A jet is upright: a pixel shows what stands on the way from the eye, up to its height.
        float time = age * lives[kind] / JET_TIME[kind], wide = max(JET_RADIUS[kind], 0.7 * pixels[kind]);
        if (time < 1.0) {
          vec2 way = turned * lean * min(1.0, (RING_REACH + 1.0) / (JET_HEIGHT[kind] * max(length(lean), 1e-3)));
          float up = clamp(-dot(d, way) / max(dot(way, way), 1e-4), 0.0, 4.0 * time * (1.0 - time) * JET_HEIGHT[kind]);
          jets += jetsSeen[kind] * (1.0 - smoothstep(0.6 * wide, wide, length(d + up * way))) * JET_RADIUS[kind] / wide;
        }
      }
      // The mean of the jets that have no cell, or are too narrow for a pixel: their area as the eye sees it, over that of the sea.
      vec2 areas = 2.0 * JET_RADIUS * 0.667 * JET_HEIGHT * waves * waves;
      jets += 1.0 - exp(-dot((1.0 - jetsSeen * shares / rings) * fluxes, JET_TIME * areas) * length(lean));
      return vec4(slope, dot(missing, vec2(layers) * shares * gains * gains) * RING_VARIANCE, min(jets, 1.0));
    }

    // Oil on the water, as a round slick with an irregular edge.
    uniform vec3 oilColor; // of a thick layer
    uniform vec3 oilFilm; // refractive indices of the oil and the water, factor on reflections of oil
    uniform vec3 oilExtinction; // [1/m] of light that goes down and up again
    uniform vec3 slick; // centre x, y, radius [m] (0: no slick)
    uniform vec3 slickOptics; // thickness [m], roughness, factor on the slope of ripples

    // Depth of a point inside the slick, 0 to 1 at the end of its rim.
    float slickCover(vec2 x) {
      if (slick.z <= 0.0) return 0.0;
      vec2 d = x - slick.xy, w = vec2(cos(wind.x), sin(wind.x));
      float off = slick.z - length(d), size = 0.4 * slick.z + 1.0;
      if (abs(off) > 1.5 * size) return off > 0.0 ? 1.0 : 0.0;
      // Wind tears the edge into streaks along itself.
      vec2 p = vec2(0.3 * dot(d, w), dot(d, vec2(-w.y, w.x))) / size;
      float torn = gradientNoise(p).x + 0.5 * gradientNoise(p * 3.3 + 5.0).x + 0.3 * gradientNoise(p * vec2(7.0, 14.0)).x;
      return smoothstep(-0.5, 1.0, off / size + 0.65 * torn);
    }

    const float THIN_FILM = 5e-8; // thickness [m] of a film that mirrors in part as oil does, in part as water
    const float RAINBOW = 1.5e-6; // thickness [m] of a film whose colours are fading

    // Thickness of the oil [m]. It varies along the wind; the rim of a slick thins out over all classes of appearance:
    // from the slick's own thickness to RAINBOW by equal factors, and then evenly, so that each colour has its band.
    float oilThickness(vec2 x, float inside) {
      if (inside <= 0.0) return 0.0;
      vec2 d = vec2(cos(wind.x), sin(wind.x));
      vec2 p = vec2(dot(x, d) / 40.0, dot(x, vec2(-d.y, d.x)) / 7.0);
      float streaks = exp(2.0 * gradientNoise(p).x + 1.2 * gradientNoise(p * 3.1 + 8.0).x);
      float thin = min(slickOptics.x, RAINBOW), towards = 2.0 * inside - 1.0;
      return streaks * thin * min(2.0 * inside, 1.0) * pow(slickOptics.x / thin, max(towards, 0.0));
    }

    // Share of the light from below that a film of oil lets through, in red, green and blue.
    vec3 lightThrough(float d) { return exp(-oilExtinction * d); }

    // Reflection of a film of oil over that of a fluid of this index, in red, green and blue (sim/ocean/fluids/oil_film.py).
    // facing: cosine of the angle from which it is seen; change: of the thickness d across a pixel, which blurs fringes.
    vec3 filmGain(float d, float change, float facing, float index) {
      float n = oilFilm.x, r1 = (1.0 - n) / (1.0 + n);
      vec3 q = (1.0 - r1 * r1) * (n - oilFilm.y) / (n + oilFilm.y) * exp(-0.5 * oilExtinction * d);
      float inOil = sqrt(1.0 - (1.0 - facing * facing) / (n * n));
      vec3 turns = 12.566371 * n * inOil / vec3(610e-9, 545e-9, 450e-9), phase = turns * d, blur = turns * change;
      vec3 fringes = exp(-0.5 * (0.002025 * phase * phase + blur * blur)) * cos(min(phase, 200.0));
      return (r1 * r1 + q * q + 2.0 * r1 * q * fringes) * pow((index + 1.0) / (index - 1.0), 2.0);
    }

    uniform vec3 firePlace; // [m]
    uniform vec3 fireLight; // radiant intensity (0: no fire)

    // Radiance mirrored from a light in direction L to the eye in direction V, over the light's irradiance: the share of
    // facets that send it there, Gaussian in slope (Cox and Munk 1954), with this variance along each axis.
    float mirroredFrom(vec3 L, vec3 V, vec2 slope, float variance, float facing, float index) {
      vec3 H = normalize(V + L);
      vec2 tilt = -H.xy / max(H.z, 0.05) - slope;
      float facets = exp(-0.5 * dot(tilt, tilt) / variance) / (6.2832 * variance);
      return fresnel(max(dot(V, H), 0.0), index) * facets / (4.0 * pow(max(H.z, 0.1), 4.0) * max(facing, 0.12));
    }

    // Bodies in the water or above it, three vectors each: x, y, cosine and sine of its heading; half sides, corner
    // [m] (0: none), top [m]; colour, bottom [m].
    uniform vec4 waterlines[3 * MAX_WATERLINES];

    // Bodies that a ray R from the water meets: (light, share of the ray). Each is taken for an upright elliptic
    // cylinder. spread: width of the ray over its length, as the facets that mirror it are tilted; around: the light on
    // them; near: distance [m] of the nearest one that stands in the water, 0 inside. One loop for both, because software
    // renderers take long to read an array.
    vec4 meetHulls(vec3 at, vec3 R, float spread, vec3 around, out float near) {
      vec4 found = vec4(0.0);
      float sunny = max(dot(-R.xy, sunDirection.xy), 0.0) / max(length(R.xy), 1e-3);
      vec3 light = around + 0.3183 * sunLight * sunny;
      near = 1e3;
      for (int k = 0; k < MAX_WATERLINES; k++) {
        vec4 place = waterlines[3 * k], size = waterlines[3 * k + 1], color = waterlines[3 * k + 2];
        if (size.z <= 0.0) break;
        vec2 d = at.xy - place.xy, e = place.zw, n = vec2(-e.y, e.x), unit = 1.0 / (size.xy + size.z);
        d = vec2(dot(d, e), dot(d, n));
        near = min(near, color.w > 0.0 ? 1e3 : length(max(abs(d) - size.xy, 0.0)) - size.z);
        vec2 p = d * unit, r = vec2(dot(R.xy, e), dot(R.xy, n)) * unit;
        float rr = max(dot(r, r), 1e-6), nearest = -dot(p, r) / rr;
        if (nearest <= 0.0) continue;
        vec2 c = p + nearest * r;
        float cc = dot(c, c), wide = spread * nearest + 0.02, gap = (sqrt(cc) - 1.0) / max(unit.x, unit.y);
        float z = at.z + max(nearest - sqrt(max(1.0 - cc, 0.0) / rr), 0.0) * R.z;
        float cover = (1.0 - smoothstep(-wide, wide, gap)) * (1.0 - smoothstep(size.w - wide, size.w + wide, z));
        if (color.w > 0.0) cover *= smoothstep(color.w - wide, color.w + wide, z);
        found = mix(found, vec4(color.rgb * light, 1.0), cover);
      }
      near = max(near, 0.0);
      return found;
    }

    const float LIGHT_LIMIT = 6.0; // radiance that is reduced to its half
    const float GLINT_SHARE = 0.7; // of the variance of slopes too fine to be drawn: that between facets that glint
    const float WIDE_GLINT_SHARE = 0.35; // the same at less detail

    // Width [m] for which facets are made, from the steps [m] to the places of the next pixels. At less detail a drawn pixel is
    // wide on the screen, and a sparkle in a single one would be a block: facets span two of them there.
    float facetWidth(vec2 steps) {
      return DETAILS > 1 ? min(steps.x, steps.y) : 1.5 * sqrt(max(steps.x * steps.y, 1e-6));
    }

    // The facet at x: its random slope, which turns with time, Gaussian with this variance along each axis; and the share
    // of its light that comes from x, of mean 1: it is brightest near its middle. So glints are single round sparkles about
    // as wide as a pixel (width, [m]), with the mean light of a smooth path.
    vec3 facetAt(vec2 x, float width, float variance) {
      vec2 p = x / exp2(ceil(log2(max(1.4 * width, 0.004))));
      p.x += 0.38 * floor(p.y);
      vec2 u = hash2(floor(p)), light = 1.0 - cos(6.2832 * (p + 0.4 * fract(17.0 * u)));
      float turn = 6.2832 * (u.y + seaState.x * (0.2 + u.x));
      return vec3(sqrt(-2.0 * variance * log(max(u.x, 1e-4))) * vec2(cos(turn), sin(turn)), light.x * light.y);
    }

    // The light from a point of the sea. at: the point [m]; rest: its position in still water [m]; steps: to the places of
    // the next pixels along and down the picture [m]. OIL: there is a slick; HULLS: something stands in the water.
    vec3 shadeSea(vec3 at, vec2 rest, vec2 steps) {
      #ifdef OIL
        float oil = slickCover(at.xy), film = oilThickness(at.xy, oil);
        vec3 clear = lightThrough(film);
        vec3 deep = mix(oilColor, deepColor, clear), scatter = mix(1.8 * oilColor, scatterColor, clear);
        vec3 optics = mix(optics, vec3(optics.x, slickOptics.y, optics.z), oil);
        // A film that is much thinner than a wave of light mirrors as the water below it does.
        optics.x = mix(optics.x, oilFilm.x, film / (film + THIN_FILM));
        optics.z *= mix(1.0, oilFilm.z, oil);
      #else
        const float oil = 0.0;
        vec3 deep = deepColor, scatter = scatterColor;
      #endif
      vec3 toEye = eye - at;
      float far = length(toEye);
      vec3 V = toEye / far;
      float lost = 1.0 - exp(-pow(far / lens.x, 1.5));
      vec3 around = meanHorizon();
      vec3 haze = mix(around, horizonGlow(-V), smoothstep(0.1, 0.7, length(V.xy)));
      if (lost > 0.995) return haze * lens.y;
      float footprint = sqrt(max(steps.x * steps.y, 1e-6));

      // Waves finer than a pixel no longer tilt it; they make it rough instead.
      vec2 slope;
      float rough, foamShare;
      #ifdef RINGS
        vec3 drawn = ringsAt(waveSlopes, rest).xyz;
        float cell = grid.z / 64.0, flatness = ringFlatness(rest);
        float blur = max(flatness, smoothstep(cell * 1.5, cell * 12.0, footprint));
        slope = drawn.xy * (1.0 - blur);
        rough = (1.0 - (1.0 - blur) * (1.0 - blur)) * seaState.z;
        foamShare = drawn.z * (1.0 - flatness);
      #else
        float coarse = max(log2(footprint * (grid.x - 1.0) / grid.z), 0.0), share = pieceShare(rest, eye);
        vec4 waves = wavesAt(waveSlopes, rest, share, coarse, true);
        slope = waves.xy;
        rough = waves.w;
        foamShare = waves.z;
      #endif
      foamShare *= 1.0 - oil;
      vec4 fine = ripples(at.xy, footprint);
      #ifdef OIL
        float calm = mix(1.0, slickOptics.z, min(2.5 * oil, 1.0)); // a sheen calms ripples as a thick layer does
        fine.xyz *= vec3(calm, calm, calm * calm);
      #endif
      slope += fine.xy;
      // Beyond the last ring, noise of the same slope continues the swell while a pixel can show it.
      #ifdef RINGS
      if (flatness > 0.0) {
        float wave = max(grid.z, 16.0) * 0.35;
        for (int k = 0; k < 3; k++) {
          float seen = flatness * (1.0 - smoothstep(0.1, 0.5, footprint / wave));
          if (seen > 0.0) {
            vec2 d = vec2(cos(wind.x + 0.5 * float(k - 1)), sin(wind.x + 0.5 * float(k - 1)));
            float along = dot(at.xy, d) - sqrt(0.159 * wind.y * wave) * seaState.x;
            vec2 n = gradientNoise(vec2(along, 0.4 * dot(at.xy, vec2(-d.y, d.x))) / wave).yz;
            slope += seen * sqrt(seaState.z) * (n.x * d + 0.4 * n.y * vec2(-d.y, d.x));
            rough -= seen * 0.3 * seaState.z;
          }
          wave *= 0.45;
        }
        rough = max(rough, 0.0);
      }
      #endif
      vec4 rings = rainSlopes(rest, footprint, toEye.xy / max(toEye.z, 0.05 * far));
      slope += rings.xy;
      float variance = optics.y * optics.y + 0.5 * (rough + fine.z + rings.z);
      float sigma = sqrt(variance);

      // At grazing angles one sees mostly the facets that are tilted towards the eye.
      vec2 level = V.xy / max(length(V.xy), 1e-4);
      float facing = clamp(dot(normalize(vec3(-slope, 1.0)), V), 0.02, 1.0);
      vec2 mirroring = roughMirror(facing, sigma, optics.x);
      float F = mirroring.x;
      vec3 N = normalize(vec3(-slope + level * mirroring.y, 1.0));
      vec3 mirror = vec3(F);
      #ifdef OIL
        if (film > 0.0) mirror *= mix(filmGain(film, fwidth(film), facing, optics.x), vec3(1.0), F);
      #endif
      mirror *= optics.z;
      vec3 R = reflect(-V, N);
      R.z = abs(R.z) + 0.01;
      R = normalize(R);
      float dim = clamp(sqrt(sigma) * 0.7, 0.0, 0.8);
      vec3 ambient = ambientLight();
      vec3 mirrored = behindRain(addClouds(sky(R, dim), R, max(dim, 0.1), ambient, true).rgb, R);
      #ifdef HULLS
        float hull;
        vec4 hulls = meetHulls(at, R, 1.5 * sigma, around, hull);
        mirrored = mix(mirrored, hulls.rgb / max(hulls.a, 1e-3), hulls.a * (1.0 - smoothstep(50.0, 60.0, hull)));
      #endif

      // Water that washes around a hull foams, the wider the higher the waves; close to it less light comes in.
      float whitened = clamp(foamShare, 0.0, 1.0);
      #ifdef HULLS
        float wash = (1.0 - smoothstep(0.0, 0.15 + 0.35 * sqrt(seaState.y), hull)) * smoothstep(0.05, 0.6, seaState.y);
        wash *= (1.0 - oil) * (0.75 + 0.5 * gradientNoise(at.xy * 2.3 - 0.4 * seaState.x).x);
        whitened = clamp(max(whitened, 0.8 * wash * wash), 0.0, 1.0);
      #endif
      vec4 bubbles = foamCover(rest, whitened, footprint);
      // Whitecaps reflect about half of the light when they are old (Koepke 1984, Appl. Opt. 23:1816): their bubbles are
      // a thin layer, and half of what is seen there is the water.
      float foam = bubbles.x * mix(0.5, 1.0, smoothstep(0.1, 0.7, whitened));

      float glints = DETAILS > 1 ? GLINT_SHARE : WIDE_GLINT_SHARE;
      vec3 facet = facetAt(rest, facetWidth(steps), glints * variance);
      float glitter = 0.5 * smoothstep(-0.02, 0.05, sunDirection.z) * optics.z * lens.z * facet.z
                    * mirroredFrom(sunDirection, V, slope + facet.xy,
                                   (1.0 - glints) * variance + 0.0004, facing, optics.x);
      vec3 toFire = firePlace - at;
      float near = dot(toFire, toFire) + 1.0;
      toFire /= sqrt(near);
      // Flames are metres wide, which blurs their image as roughness does.
      float image = optics.z * mirroredFrom(toFire, V, slope, variance + 0.002, facing, optics.x);

      // Light that comes out of the water: from the deep, and through crests with the sun behind them.
      float sunUp = max(dot(N, sunDirection), 0.0);
      vec3 fire = fireLight / near;
      vec3 lit = ambient + (sunLight * sunUp + fire * max(dot(N, toFire), 0.0)) * 0.3183;
      float crest = clamp(at.z / max(seaState.y, 0.01) + 0.15, 0.0, 1.2);
      float through = pow(clamp(dot(-V, normalize(sunDirection - 0.35 * N)) * 0.5 + 0.5, 0.0, 1.0), 3.0);
      vec3 body = deep * lit;
      body += scatter * (ambient * (0.10 + 0.35 * crest * crest) * facing
                        + sunLight * 0.3183 * crest * through * (0.15 + 0.5 * (1.0 - facing)));
      // Water full of air under and around foam is bright.
      body += scatter * lit * 0.5 * smoothstep(0.0, 0.7, foamShare);

      vec3 color = mix(body, mirrored, mirror) + sunLight * glitter + fire * image;
      // As in the photograph of the sky, radiances far above the rest are compressed.
      color /= 1.0 + dot(color, vec3(0.3, 0.5, 0.2)) / LIGHT_LIMIT;
      // Foam scatters the light of sun and sky many times. The sky is that overhead and that around; below clouds and
      // rain, what comes from overhead has the colour of the haze. Bubbles stand up to a sun that is low.
      vec3 skylight = mix(0.65 * behindRain(ambient, vec3(0.0, 0.0, 1.0)) + 0.35 * around, around, clouds.x);
      vec3 M = normalize(vec3(-slope - bubbles.yz, 1.0));
      vec3 white = foamColor * (skylight + 0.3183 * sunLight * max(0.8 * dot(M, sunDirection) + 0.2, 0.0)
                              + 0.3183 * fire * max(dot(M, toFire), 0.0));
      color = mix(color, white * bubbles.w, foam);
      color = mix(color, skylight, 0.8 * rings.w);

      #ifdef HULLS
        color *= 0.65 + 0.35 * smoothstep(0.0, 0.6, hull);
      #endif
      return mix(color, haze, lost) * lens.y;
    }`,

  dome: `
    // The sun's disc, twice as wide as the true one.
    float sunDisc(float off) { return 30.0 * (1.0 - smoothstep(0.006, 0.014, off)); }
    // The light from the sky in the direction d, above the horizon.
    vec3 skyLight(vec3 d) {
      float off = length(d - sunDirection);
      vec4 layer = addClouds(clearSky(d) + sunLight * sunGlow(off), d, 0.0, ambientLight(), false);
      float through = 1.0 - layer.a;
      // The lowest degree of the sky passes into the haze over the far sea, or a line would part them.
      layer.rgb = mix(horizonGlow(d), layer.rgb, smoothstep(-0.003, 0.025, d.z));
      return behindRain(layer.rgb + sunLight * sunDisc(off) * lens.z * through * through, d) * lens.y;
    }`,
};

// A vertex of the polar grid (polar_grid.js) by ring and spoke, counted from the first that are drawn: where it rests, and
// where the waves move it.
export const POLAR_GLSL = `
  uniform vec3 eye; // [m]
  uniform vec4 polarPlace; // x, y of the middle of the grid, its distance from below the eye, height that sets steps [m]
  uniform vec4 polarSteps; // of rings: the first, step, the last with waves; angle between spokes [rad]
  uniform float polarTurn; // [rad] of the first spoke
  ${WATER_GLSL.noise}
  ${WATER_GLSL.waves}
  vec3 placeOf(float ring, float spoke, out vec2 rest) {
    float last = polarSteps.z, s = polarSteps.x + polarSteps.y * ring, angle = polarTurn + polarSteps.w * spoke;
    float reach = polarPlace.z + polarPlace.w * sinh(last);
    float far = s > last + 0.5 * polarSteps.y ? reach * exp2((s - last) / polarSteps.y) : polarPlace.z + polarPlace.w * sinh(s);
    rest = polarPlace.xy + far * vec2(cos(angle), sin(angle));
    // Heights are means over about half a triangle, so that waves do not flicker where the grid moves over them.
    #ifdef RINGS
      vec3 moved = ringsAt(wavePlaces, rest).xyz * (1.0 - ringFlatness(rest));
    #else
      float wide = max(polarSteps.y * polarPlace.w * cosh(min(s, last)), polarSteps.w * far);
      float level = max(log2(0.5 * wide * (grid.x - 1.0) / grid.z), 0.0);
      vec3 moved = wavesAt(wavePlaces, rest, pieceShare(rest, eye), level, false).xyz;
      moved *= 1.0 - smoothstep(0.7, 1.0, far / reach);
    #endif
    return vec3(rest, 0.0) + moved;
  }`;
// PLACED: the vertices are in a texture (lit_sea.js), as two texels each.
export const WATER_VERTEX = `
  uniform mat4 fromSea;
  uniform float farDepth;
  varying vec3 vSea;
  varying vec2 vRest;
  #ifdef PLACED
    uniform highp sampler2D seaVertices;
  #else
    ${POLAR_GLSL}
  #endif
  void main() {
    #ifdef PLACED
      ivec2 at = ivec2(2.0 * position.y, position.x);
      vSea = texelFetch(seaVertices, at, 0).xyz;
      vRest = texelFetch(seaVertices, at + ivec2(1, 0), 0).xy;
    #else
      vSea = placeOf(position.x, position.y, vRest);
    #endif
    gl_Position = projectionMatrix * viewMatrix * fromSea * vec4(vSea, 1.0);
    // Sea beyond the camera's range is drawn at its end, as the sea reaches the horizon.
    float end = (farDepth > 0.5 ? 1.0 - 1e-6 : 1e-9) * gl_Position.w;
    gl_Position.z = farDepth > 0.5 ? min(gl_Position.z, end) : max(gl_Position.z, end);
  }`;

// A line over the sides of the cells of the simulated grid.
export const WIRE_GLSL = `
  uniform vec3 wireColor;
  float wireAt(vec2 rest) {
    #ifdef RINGS
      vec2 p = rest - gridMiddle.xy, cell = vec2(ringAt(length(p)), atan(p.y, p.x + 1e-9) / 6.2831853 * grid.y);
    #else
      vec2 cell = rest * (grid.xy - 1.0) / grid.z;
    #endif
    vec2 wide = fwidth(cell), off = abs(fract(cell - 0.5) - 0.5) / max(wide, 1e-6);
    vec2 line = (1.0 - smoothstep(0.4, 1.1, off)) * (1.0 - smoothstep(0.2, 0.6, wide));
    return max(line.x, line.y);
  }`;

// The place of the sea that a pixel shows, and where there is no water.
export const WATER_PLACE = `
  #define STANDARD
  uniform vec3 eye;
  varying vec3 vSea;
  varying vec2 vRest;
  uniform vec3 cutout; // middle x, y of a side of the rectangle without surface, half its length [m] (0: no cutout)
  uniform vec3 cutoutDirection; // unit vector from that side to the opposite one, and their distance [m]
  void cutOut() {
    // A shader with "discard" shades the waves that are hidden, too.
    #ifdef CUTOUT
      vec2 from = vSea.xy - cutout.xy;
      float across = dot(from, cutoutDirection.xy), along = dot(from, vec2(-cutoutDirection.y, cutoutDirection.x));
      if (across > 0.0 && across < cutoutDirection.z && abs(along) < cutout.z) discard;
    #endif
  }
  // The middle of a pixel at the horizon may lie beyond the mesh, where places have passed through infinity.
  vec3 seaPlace() {
    if (gl_FragCoord.w >= 1e-6) return vSea;
    return eye + 1e6 * normalize((vSea - eye) * (gl_FragCoord.w < 0.0 ? -1.0 : 1.0));
  }
  vec2 stepsAt(vec3 at) { return vec2(length(dFdx(at.xy)), length(dFdy(at.xy))); }`;
export const WATER_LIGHT = `
  #define MAX_WATERLINES ${MAX_WATERLINES}
  ${WATER_GLSL.noise}
  ${WATER_GLSL.waves}
  ${WATER_GLSL.sky}
  ${WATER_GLSL.surface}`;
export const WATER_FRAGMENT = `
  ${WATER_PLACE}
  ${WATER_LIGHT}
  ${WIRE_GLSL}
  void main() {
    cutOut();
    vec3 at = seaPlace();
    gl_FragColor = vec4(shadeSea(at, vRest, stepsAt(at)), 1.0);
    #ifdef WIRE
      gl_FragColor.rgb = mix(gl_FragColor.rgb, wireColor, wireAt(vRest));
    #endif
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`;

// The sea in few words: its colour, and the sky at its horizon where one looks flatly at it.
export const PLAIN_FRAGMENT = `
  ${WATER_PLACE}
  uniform vec3 deepColor, lens, standIn;
  void main() {
    cutOut();
    vec3 V = eye - seaPlace(), N = normalize(cross(dFdx(vSea), dFdy(vSea)));
    float far = length(V), grazing = pow(1.0 - abs(dot(N, V)) / far, 4.0), lost = 1.0 - exp(-far / lens.x);
    gl_FragColor = vec4(mix(mix(deepColor, standIn, 0.7 * grazing), standIn, lost), 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`;

export const TILE = 16; // [pixels] side of the squares in which sea and sky are shaded
// The corners of tiles of the canvas (lit_sea.js), by position: column, row, and which corner. Other tiles than those of
// one kind, sea (0) or anything else (1), have no area.
export const TILE_GLSL = `
  uniform highp sampler2D seaTiles, seaPlaces;
  vec4 tileCorner(int kind, float depth) {
    float isDrawn = texelFetch(seaTiles, ivec2(position.xy), 0)[kind];
    vec2 corner = isDrawn * vec2(mod(position.z, 2.0), floor(0.5 * position.z));
    return vec4(2.0 * ${TILE}.0 * (position.xy + corner) / vec2(textureSize(seaPlaces, 0)) - 1.0, depth, 1.0);
  }`;
// The tiles that are not all sea, or a triangle that covers the view, at the far plane. They are drawn after everything
// opaque, so that only free pixels are shaded.
export const DOME_VERTEX = `
  uniform mat4 toSea;
  uniform float farDepth;
  varying vec3 vRay;
  ${TILE_GLSL}
  void main() {
    #ifdef TILES
      gl_Position = tileCorner(1, farDepth);
    #else
      gl_Position = vec4(position.xy, farDepth, 1.0);
    #endif
    vec4 view = inverse(projectionMatrix) * vec4(gl_Position.xy, 0.5, 1.0);
    vRay = mat3(toSea) * (inverse(mat3(viewMatrix)) * (view.xyz / view.w));
  }`;
export const DOME_FRAGMENT = `
  #define STANDARD
  uniform mat4 toSea;
  ${WATER_GLSL.noise}
  ${WATER_GLSL.sky}
  ${WATER_GLSL.dome}
  varying vec3 vRay;
  void main() {
    vec3 d = normalize(vRay);
    // Below the horizon, where the mesh of the sea ends, is haze.
    gl_FragColor = vec4(d.z < 0.0 ? horizonGlow(d) * lens.y : skyLight(d), 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`;

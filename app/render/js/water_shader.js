// The shading of water and sky in GLSL: functions by name, and the two programs made of them. Used by water.js.

const WATER_GLSL = {
  vertex: `
    attribute vec3 aux;
    uniform mat4 toSea;
    uniform vec3 grid; // rows, columns (0: no grid), side of a tile or radius of the mesh [m]
    varying vec3 vSea;
    varying vec2 vRest;
    varying vec3 vAux;
    #include <common>
    void main() {
      #include <begin_vertex>
      #include <project_vertex>
      vec4 sea = toSea * modelMatrix * vec4(position, 1.0);
      vSea = sea.xyz;
      vAux = aux;
      // Where the water of this vertex rests: foam noise that is keyed to it travels with the water.
      vRest = sea.xy;
      if (grid.x > 0.0) {
        int columns = int(grid.y);
        vec2 cell = vec2(grid.z) / (grid.xy - 1.0);
        vec2 tile = (toSea * modelMatrix * vec4(0.0, 0.0, 0.0, 1.0)).xy;
        vRest = tile + vec2(gl_VertexID / columns, gl_VertexID % columns) * cell;
      }
    }`,

  // The sky as seen and as mirrored, in one function, so that sea and sky meet without a line.
  sky: `
    #include <cube_uv_reflection_fragment>
    #include <envmap_common_pars_fragment>
    uniform mat4 fromSea;
    uniform vec3 skyline; // land in the photograph towards the sun and away from it [rad], stretch of the low sky
    uniform vec3 fold; // share of the photograph's azimuths in use, blur of the haze, brightest radiance kept
    uniform vec3 sunDirection;
    uniform vec3 sunColor;
    uniform vec3 tint; // a filter before the photograph
    uniform vec3 weather; // cloud cover, size of clouds, direction of the wind [rad]
    uniform vec3 place; // gravity [m/s2], share of the sun's disc and glitter that shows, darkness of thick cloud
    uniform vec3 state; // time [s], significant height [m], mean square slope of the mesh

    // The photographs were taken on land. Their elevations are remapped so that the land lies below our horizon, and
    // where tall things stand around, only the azimuths on either side of the sun are used, spread over the circle.
    float sunBearing() { return atan(sunDirection.y, sunDirection.x + 1e-6); }

    vec3 unland(vec3 d, float side) {
      float bearing = atan(d.y, d.x) - sunBearing();
      bearing = mod(bearing + 3.14159265, 6.2831853) - 3.14159265;
      float land = mix(skyline.x, skyline.y, 0.5 - 0.5 * cos(bearing));
      float e = asin(clamp(d.z, 0.0, 1.0)) / 1.5707963;
      float g = skyline.z, l = land / 1.5707963;
      e = 1.5707963 * (l + e * (g + (1.0 - l - g) * e));
      float a = bearing * fold.x * side + sunBearing();
      return vec3(cos(e) * cos(a), cos(e) * sin(a), sin(e));
    }

    vec3 lookup(vec3 d, float blur) {
      #if defined(USE_ENVMAP) && defined(ENVMAP_TYPE_CUBE_UV)
        vec3 c = textureCubeUV(envMap, envMapRotation * (mat3(fromSea) * d), blur).rgb;
        // Bright places keep their hue; the sun's own disc is drawn where it belongs, not through a blurred photograph.
        float light = dot(c, vec3(0.3, 0.5, 0.2));
        c = max(mix(vec3(light), c, 1.15), 0.0) * pow(tint, vec3(0.7 + 2.0 * clamp(d.z, 0.0, 0.6)));
        return c / (1.0 + light / fold.z) * envMapIntensity;
      #else
        return mix(vec3(0.75, 0.8, 0.85), vec3(0.2, 0.4, 0.7), sqrt(max(d.z, 0.0)));
      #endif
    }

    float billow(vec2 p, int octaves) {
      vec2 drift = vec2(ruffle(p * 0.6 + 4.0).x, ruffle(p * 0.6 - 9.0).x);
      p += 0.7 * drift;
      float n = 0.0, size = 1.0;
      for (int k = 0; k < octaves; k++) {
        n += size * ruffle(p).x;
        p = mat2(1.6, 1.2, -1.2, 1.6) * p + 3.7;
        size *= 0.52;
      }
      return n;
    }

    // A layer of cloud before the photograph, so that no two seas have the same sky. The last number is how much of
    // the sky it hides.
    vec4 clouded(vec3 c, vec3 d, float blur, vec3 ambient) {
      if (weather.x <= 0.0 || d.z < 0.004) return vec4(c, 0.0);
      vec2 w = vec2(cos(weather.z), sin(weather.z));
      vec2 p = d.xy / (d.z + 0.11);
      p = vec2(dot(p, w) * 0.55 - 0.004 * state.x, dot(p, vec2(-w.y, w.x))) / weather.y;
      int octaves = blur < 0.1 ? 6 : 3;
      float n = billow(p, octaves) + 1.3 * (weather.x - 0.5);
      float cover = smoothstep(-0.12 - blur, 0.55 + blur, n);
      vec2 s = normalize(sunDirection.xy + 1e-4);
      if (cover <= 0.003) return vec4(c, 0.0);
      float lit = 0.6; // mirrored clouds are not modelled in relief
      if (blur < 0.1) {
        float sunward = billow(p + 0.22 * vec2(dot(s, w), dot(s, vec2(-w.y, w.x))), 3);
        lit = clamp(0.55 + 1.4 * (n - 1.3 * (weather.x - 0.5) - sunward), 0.15, 1.2);
      }
      float near = max(dot(d, sunDirection), 0.0);
      vec3 glow = sunColor * (0.05 + 0.10 * lit + 0.5 * pow(near, 24.0) * (1.2 - cover) + 0.12 * pow(near, 3.0) * lit);
      // The thicker, the darker from below: torn edges stay bright, bellies go grey.
      float thick = 1.0 - place.z * smoothstep(-0.5, 0.45, n - 1.3 * (weather.x - 0.5));
      vec3 cloud = (ambient * (0.55 + 0.45 * lit) + glow) * thick;
      return vec4(mix(c, cloud, cover * 0.92 * smoothstep(0.0, 0.09, d.z)), cover);
    }

    vec3 sky(vec3 d, float blur) {
      vec3 c = lookup(unland(d, 1.0), blur);
      // Behind one's back the two ends of the spread photograph meet: there each is blended with its mirror image.
      if (fold.x < 1.0) {
        vec2 s = normalize(sunDirection.xy + 1e-6), l = d.xy / max(length(d.xy), 1e-4);
        float back = smoothstep(0.3, 1.0, -dot(s, l));
        if (back > 0.0) c = mix(c, lookup(unland(d, -1.0), blur), 0.5 * back);
      }
      return c;
    }

    vec3 ambientLight() { return lookup(vec3(0.0, 0.0, 1.0), 1.0); }

    vec3 horizon(vec3 d) { return sky(vec3(d.xy / max(length(d.xy), 1e-4), 0.0), fold.y); }`,

  noise: `
    #include <common>
    vec2 hash2(vec2 p) {
      uvec2 q = uvec2(ivec2(p)) * uvec2(1597334673u, 3812015801u);
      uint n = (q.x ^ q.y) * 1597334673u;
      return vec2(n & 0xffffu, n >> 16) / 65535.0;
    }
    // Gradient noise and its two derivatives.
    vec3 ruffle(vec2 p) {
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
    uniform vec3 grid;
    uniform vec3 deep;
    uniform vec3 scatter;
    uniform vec3 foamColor;
    uniform vec3 optics; // refractive index, roughness, specular scale
    uniform vec3 air; // haze distance [m], exposure, foam scale [m]
    uniform vec3 ripple; // rms slope, longest and shortest wave [m]
    uniform vec3 extent; // tiles along a side, dome, wire

    float schlick(float f0, float c) { float m = clamp(1.0 - c, 0.0, 1.0); float m2 = m * m; return f0 + (1.0 - f0) * m2 * m2 * m; }

    // Slopes of ripples too short for the mesh, with as much variance in each octave, as wind waves have in their
    // equilibrium range. An octave fades where it would be finer than a pixel; its variance is then in z instead.
    // Phase speeds are those of deep water.
    vec4 ripples(vec2 x, float footprint) {
      vec2 slope = vec2(0.0);
      float lost = 0.0, wave = ripple.y, angle = weather.z;
      float octaves = clamp(1.0 + floor(log(ripple.y / ripple.z) / 0.755), 1.0, 9.0);
      float each = ripple.x * ripple.x / octaves;
      // Gusts: patches of rougher and smoother water, and nothing in it repeats from tile to tile.
      float gust = 0.65 + 0.5 * ruffle(x / (ripple.y * 24.0) + state.x * 0.02).x
                        + 0.5 * ruffle(x / (ripple.y * 7.0) - state.x * 0.03).x;
      gust = max(gust, 0.15) * 1.3;
      for (int k = 0; k < 9; k++) {
        if (float(k) >= octaves) break;
        float seen = 1.0 - smoothstep(0.12, 0.5, footprint / wave);
        lost += each * (1.0 - seen * seen);
        if (seen > 0.0) {
          vec2 d = vec2(cos(angle), sin(angle));
          float speed = sqrt(place.x * wave / 6.2832);
          // Crests are longer than they are wide.
          vec2 along = vec2(dot(x, d) - speed * state.x, 0.6 * dot(x, vec2(-d.y, d.x)));
          vec3 n = ruffle(along / wave);
          slope += seen * sqrt(each) * 1.6 * (n.y * d + 0.6 * n.z * vec2(-d.y, d.x));
        }
        wave *= 0.47;
        angle += (mod(float(k), 2.0) < 0.5 ? 0.9 : -1.3);
      }
      return vec4(slope * gust, lost * gust * gust, gust);
    }

    // Distance from the walls between the cells around random points: 0 on a wall, up to about 0.5 inside.
    float cells(vec2 p) {
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

    // Foam from the coverage the solver asks for: (cover, thickness). A web of bubble lines that widen with the
    // coverage and close into a mat, streaked along the wind.
    vec2 froth(vec2 x, float asked, float footprint) {
      if (asked <= 0.004) return vec2(0.0);
      vec2 d = vec2(cos(weather.z), sin(weather.z));
      vec2 p = vec2(dot(x, d) * 0.7, dot(x, vec2(-d.y, d.x))) / air.z;
      vec2 drift = vec2(ruffle(p * 0.43 + 3.1).x, ruffle(p * 0.43 - 7.7).x);
      p += drift * 1.1;
      float big = ruffle(p * 0.5 + 11.0).x;
      float c = clamp(asked * (1.0 + 0.9 * big), 0.0, 1.0);
      // Cells: the distance to the nearest bubble wall, coarse ones holding fine ones.
      float near = 1.0 - smoothstep(0.1, 0.5, footprint / air.z);
      float crumb = 0.35;
      vec2 q = p + 0.30 * vec2(ruffle(p * 2.3).x, ruffle(p * 2.3 + 9.0).x);
      float wall = cells(q * 1.4);
      if (near > 0.0) {
        crumb = mix(0.35, cells(q * 4.7), near);
      }
      float grain = 0.5;
      if (footprint < 0.06 * air.z) grain = 0.5 + 0.8 * ruffle(p * 31.0).x;
      float edge = 0.10 + 0.25 * clamp(footprint / air.z, 0.0, 1.0);
      float width = 0.75 * c * c + 0.22 * c;
      float web = 1.0 - smoothstep(width - edge, width + edge, min(wall, 0.16 + 0.8 * crumb) + 0.06);
      float mat = smoothstep(0.35, 0.95, c + 0.35 * (0.4 - crumb) + 0.25 * (grain - 0.5) + 0.3 * big);
      float torn = smoothstep(-0.25, 0.25, ruffle(p * 1.9 + 21.0).x + 1.2 * c - 0.35);
      float cover = max(web * torn * smoothstep(0.02, 0.5, c) * (1.0 - 0.5 * crumb), mat);
      return vec2(clamp(cover, 0.0, 1.0), clamp(0.35 + 0.65 * mat - 0.5 * crumb + 0.3 * (grain - 0.5), 0.0, 1.0));
    }

    // A round slick of another fluid on the water, its edge torn into tongues and patches: how much of the sea is it.
    uniform vec3 slick; // middle x, y, radius [m] (0: none)
    uniform vec3 slickDeep;
    uniform vec3 slickScatter;
    uniform vec3 slickOptics; // refractive index, roughness, factor on the slope of ripples

    float slickCover(vec2 x) {
      if (slick.z <= 0.0) return 0.0;
      vec2 d = x - slick.xy;
      float off = slick.z - length(d), size = 0.22 * slick.z + 1.0;
      if (abs(off) > 1.5 * size) return off > 0.0 ? 1.0 : 0.0;
      float torn = ruffle(d / size).x + 0.5 * ruffle(d / size * 2.7 + 5.0).x + 0.25 * ruffle(d / size * 7.1 - 3.0).x;
      return smoothstep(-0.05, 0.05, off / size + 0.8 * torn);
    }
    vec3 deepUnder(float oil) { return mix(deep, slickDeep, oil); }
    vec3 scatterUnder(float oil) { return mix(scatter, slickScatter, oil); }
    vec3 opticsUnder(float oil) { return mix(optics, vec3(slickOptics.xy, optics.z), oil); }

    // at: the point [m]; rest: where its water rests; aux: slopes and foam; flat: 1 where no mesh is left.
    vec3 shadeSea(vec3 at, vec2 rest, vec3 aux, float flatness) {
      float oil = slickCover(at.xy);
      vec3 deep = deepUnder(oil), scatter = scatterUnder(oil), optics = opticsUnder(oil);
      aux.z *= 1.0 - oil;
      vec3 eye = (toSea * vec4(cameraPosition, 1.0)).xyz;
      vec3 toEye = eye - at;
      float far = length(toEye);
      vec3 V = toEye / far;
      float lost = 1.0 - exp(-pow(far / air.x, 1.5));
      vec3 haze = horizon(-V);
      if (lost > 0.995) return haze * air.y;
      vec2 fx = dFdx(at.xy), fy = dFdy(at.xy);
      float footprint = pow(max(dot(fx, fx) * dot(fy, fy), 1e-12), 0.25);

      // Waves finer than the pixel stop tilting it and make it rough instead.
      float cell = grid.z / max(grid.x, 64.0);
      float blur = max(flatness, smoothstep(cell * 1.5, cell * 12.0, footprint));
      vec4 fine = ripples(at.xy, footprint);
      float calm = mix(1.0, slickOptics.z, oil);
      fine.xyz *= vec3(calm, calm, calm * calm);
      vec2 slope = aux.xy * (1.0 - blur) + fine.xy;
      float rough = blur * state.z;
      // Beyond the mesh, noise of the same slope goes on as swell for as long as a pixel can show it.
      if (flatness > 0.0) {
        float wave = max(grid.z, 16.0) * 0.35;
        for (int k = 0; k < 3; k++) {
          float seen = flatness * (1.0 - smoothstep(0.1, 0.5, footprint / wave));
          if (seen > 0.0) {
            vec2 d = vec2(cos(weather.z + 0.5 * float(k - 1)), sin(weather.z + 0.5 * float(k - 1)));
            float along = dot(at.xy, d) - sqrt(0.159 * place.x * wave) * state.x;
            vec2 n = ruffle(vec2(along, 0.4 * dot(at.xy, vec2(-d.y, d.x))) / wave).yz;
            slope += seen * sqrt(state.z) * (n.x * d + 0.4 * n.y * vec2(-d.y, d.x));
            rough -= seen * 0.3 * state.z;
          }
          wave *= 0.45;
        }
        rough = max(rough, 0.0);
      }
      vec2 bubbles = froth(rest, clamp(aux.z, 0.0, 1.0), footprint);
      float foam = bubbles.x;
      float variance = optics.y * optics.y + 0.5 * (rough + fine.z);
      float sigma = sqrt(variance);

      // At grazing angles the facets that one sees are those tilted towards the eye.
      vec2 level = V.xy / max(length(V.xy), 1e-4);
      float graze = 1.0 - V.z;
      vec3 N = normalize(vec3(-slope + level * sigma * 0.9 * graze * graze, 1.0));
      float facing = clamp(dot(N, V), 0.02, 1.0);

      // Fresnel over a rough surface: Bruneton, Neyret & Holzschuch 2010, eq. 18.
      float f0 = pow((optics.x - 1.0) / (optics.x + 1.0), 2.0);
      float F = f0 + (1.0 - f0) * pow(1.0 - facing, 5.0 * exp(-2.69 * sigma)) / (1.0 + 22.7 * pow(sigma, 1.5));
      F *= optics.z;
      vec3 R = reflect(-V, N);
      R.z = abs(R.z) + 0.01;
      R = normalize(R);
      float dim = clamp(sqrt(sigma) * 0.7, 0.0, 0.8);
      vec3 ambient = ambientLight();
      vec3 mirrored = clouded(sky(R, dim), R, max(dim, 0.1), ambient).rgb;

      // Sun glitter: the share of facets that send the sun to the eye, Gaussian in slope (Cox & Munk 1954).
      vec3 H = normalize(V + sunDirection);
      vec2 tilt = -H.xy / max(H.z, 0.05) - slope;
      float spread = variance + 0.0004;
      float facets = exp(-0.5 * dot(tilt, tilt) / spread) / (6.2832 * spread);
      float glitter = schlick(f0, dot(V, H)) * facets / (4.0 * pow(max(H.z, 0.1), 4.0) * max(facing, 0.12));
      glitter *= 0.5 * smoothstep(-0.02, 0.05, sunDirection.z) * optics.z * place.y;

      // Light that comes back out of the water: the deep, and crests with the sun behind them.
      float sunUp = max(dot(N, sunDirection), 0.0);
      vec3 lit = ambient + sunColor * sunUp * 0.3183;
      float crest = clamp(at.z / max(state.y, 0.01) + 0.15, 0.0, 1.2);
      float through = pow(clamp(dot(-V, normalize(sunDirection - 0.35 * N)) * 0.5 + 0.5, 0.0, 1.0), 3.0);
      vec3 body = deep * lit;
      body += scatter * (ambient * (0.10 + 0.35 * crest * crest) * facing
                        + sunColor * 0.3183 * crest * through * (0.15 + 0.5 * (1.0 - facing)));
      // Water full of air under and around foam is bright.
      body += scatter * lit * 0.5 * smoothstep(0.0, 0.7, aux.z);

      vec3 color = mix(body, mirrored, F) + sunColor * glitter * (1.0 - foam);
      // Foam scatters light many times: it takes it from all sides.
      vec3 white = foamColor * (ambient * 1.15 + sunColor * 0.3183 * (0.35 + 0.65 * sunUp)) * (0.72 + 0.38 * bubbles.y);
      color = mix(color, white, foam * (0.6 + 0.4 * bubbles.y));

      return mix(color, haze, lost) * air.y;
    }`,
};

const WATER_FRAGMENT = `
  #define STANDARD
  uniform mat4 toSea;
  ${WATER_GLSL.noise}
  ${WATER_GLSL.sky}
  ${WATER_GLSL.surface}
  varying vec3 vSea;
  varying vec2 vRest;
  varying vec3 vAux;
  uniform vec3 pit; // middle x, y of a wall of the hole in the sea, half its length [m] (0: none)
  uniform vec3 pitWay; // unit vector from that wall to the one across, and how far that is [m]
  void main() {
    vec2 from = vSea.xy - pit.xy;
    float across = dot(from, pitWay.xy), along = dot(from, vec2(-pitWay.y, pitWay.x));
    if (across > 0.0 && across < pitWay.z && abs(along) < pit.z) discard;
    // Towards the rim of the last tile the waves go flat, as the sea beyond is.
    float flatness = 0.0;
    if (extent.y > 0.0) {
      vec2 outward = abs(vSea.xy - 0.5 * grid.z) / (0.5 * grid.z * extent.x);
      flatness = smoothstep(0.8, 1.0, grid.x > 0.0 ? max(outward.x, outward.y) : length(vSea.xy) / grid.z);
    }
    gl_FragColor = vec4(shadeSea(vSea, vRest, vAux * vec3(1.0, 1.0, 1.0 - flatness), flatness), 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`;

// A triangle that covers the view at the far plane, drawn after everything opaque: only what is left is shaded.
const DOME_VERTEX = `
  uniform mat4 toSea;
  uniform float farDepth;
  varying vec3 vRay;
  void main() {
    gl_Position = vec4(position.xy, farDepth, 1.0);
    vec4 view = inverse(projectionMatrix) * vec4(position.xy, 0.5, 1.0);
    vRay = mat3(toSea) * (inverse(mat3(viewMatrix)) * (view.xyz / view.w));
  }`;
const DOME_FRAGMENT = `
  #define STANDARD
  uniform mat4 toSea;
  ${WATER_GLSL.noise}
  ${WATER_GLSL.sky}
  ${WATER_GLSL.surface}
  varying vec3 vRay;
  // The disc, twice as wide as the true one, and the glow of the air around it.
  float disc(float off) { return 30.0 * (1.0 - smoothstep(0.006, 0.014, off)) + 2.4 * exp(-off * 60.0); }
  float glow(float off) { return 0.30 * exp(-off * 16.0) + 0.07 * exp(-off * 4.0); }
  // The photographs' colour comes in blocks of some degrees: take the light sharp and the hue soft.
  vec3 clearSky(vec3 d) {
    vec3 sharp = sky(d, 0.08), soft = sky(d, 0.33);
    vec3 w = vec3(0.3, 0.5, 0.2);
    float light = dot(sharp, w), even = dot(soft, w);
    float detail = 0.6 * smoothstep(0.15, 0.5, abs(light - even) / even);
    return mix(soft * (light / even), sharp, detail);
  }
  void main() {
    vec3 d = normalize(vRay);
    vec3 eye = (toSea * vec4(cameraPosition, 1.0)).xyz;
    float down = max(-d.z, 1e-5);
    vec3 at = vec3(eye.xy + d.xy * min(max(eye.z, 0.0) / down, 1e5), 0.0);
    // Below the horizon lies the sea that no mesh reaches.
    vec3 c;
    if (d.z < 0.0) {
      c = shadeSea(at, at.xy, vec3(0.0), 1.0);
    } else {
      float off = length(d - sunDirection);
      vec4 clouds = clouded(clearSky(d) + sunColor * glow(off), d, 0.0, ambientLight());
      float through = 1.0 - clouds.a;
      c = (clouds.rgb + sunColor * disc(off) * place.y * through * through) * air.y;
    }
    gl_FragColor = vec4(c, 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`;


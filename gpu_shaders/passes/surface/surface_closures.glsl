// Closures of lobes and of diffuse light, as Cycles composes them.
// Included by surface_lighting, where the light of lobes is; COATED, OTHER_CLOSURES: the rarer ones.

Closure reflecting(Reflected reflected)
{
  return Closure(finite_light(reflected.light),
                 vec3(0.0),
                 0.0,
                 finite_light(reflected.unsplit),
                 finite_light(reflected.shift));
}

// What is seen through glass is never splatted: it has a circle of confusion of its own.
Closure with_refracted(Closure closure, vec3 light)
{
  closure.radiance += finite_light(light);
  closure.unsplit += finite_light(light);
  return closure;
}

Lobe no_lobe()
{
  return Lobe(vec3(0.0), vec3(0.0), 0.0, false, vec3(0.0));
}

// A metal of a colour head on and of a tint of its edge, which is at 82 degrees.
Lobe metal(vec3 weight, vec3 color, vec3 tint)
{
  const float c = 1.0 / 7.0;
  vec3 f0 = min(color, vec3(1.0));
  float m = 1.0 - c, m5 = m * m * m * m * m;
  vec3 edge = mix(f0, vec3(1.0), m5);
  return Lobe(weight, f0, 0.0, true, edge * (1.0 - min(tint, vec3(1.0))) / (c * m5 * m));
}

// The surface's shading with its shape of diffuse light.
Shading shaped(Shading s, Bsdf bsdf)
{
#ifdef SHAPES
  s.shape = bsdf.shape;
  s.shape.numbers = vec4(number_or_zero(bsdf.shape.numbers.xyz), 0.0);
  if (s.shape.kind == SHAPE_ROUGH) {
    s.shape.numbers.x = clamp(s.shape.numbers.x, 0.0, 1.0);
    s.shape.numbers.y = dot(clamp(number_or_zero(bsdf.color), 0.0, 1.0), vec3(1.0 / 3.0));
  }
#endif
  return s;
}

Closure closure_diffuse(Shading s, Bsdf bsdf)
{
  s = shaped(s, bsdf);
  Reflected reflected = diffuse_light(s);
  // Negative colours reflect nothing, as in Cycles; negative lamps do take light away.
  vec3 c = max(number_or_zero(bsdf.color), vec3(0.0));
  return reflecting(Reflected(c * reflected.light, c * reflected.unsplit, c * reflected.shift));
}

Closure closure_glossy(Shading s, Bsdf bsdf)
{
  float r = clamp(number_or_zero(bsdf.roughness), 0.0, 1.0);
  vec3 albedo = ggx_albedo(ggx_tx, s.cos_view, r);
  vec3 c = max(number_or_zero(bsdf.color), vec3(0.0));
  // The same reflectance in every direction: a lobe of f0 = 1, with the colour as its weight.
  // Above 1 light grows with every scattering; from about 8 on its sum has no limit.
  vec3 repeat_color = bsdf.repeats ? ggx_multiple_scattering(albedo, min(c, vec3(5.0))) : vec3(1.0);
  Lobe lobe = Lobe(c * repeat_color, vec3(1.0), 0.0, false, vec3(0.0));
  return reflecting(glossy_light(s, r, lobe, no_lobe()));
}

#ifdef COATED
// A clear layer on top: it mirrors, tints what passes it twice, and takes what it mirrors from below.
Closure coated(Shading s, Bsdf bsdf, Closure below)
{
  if (dot(bsdf.coat_normal, bsdf.coat_normal) > 0.0) {
    s.normal = normalize(bsdf.coat_normal);
    s.cos_view = clamp(dot(s.normal, s.view), 1e-4, 1.0);
  }
  float r = clamp(number_or_zero(bsdf.coat_roughness), 0.0, 1.0);
  float share = clamp(number_or_zero(bsdf.coat), 0.0, 1.0);
  float eta = max(number_or_zero(bsdf.coat_ior), 1.0);
  Lobe lobe = Lobe(vec3(share), vec3(f0_from_ior(eta)), eta, true, vec3(0.0));
  vec3 taken = lobe_albedo(lobe, ggx_albedo(ggx_tx, s.cos_view, r), s.cos_view);
  // The path through the layer is longer where it is seen at an angle.
  float inside = sqrt(max(1.0 - (1.0 - s.cos_view * s.cos_view) / (eta * eta), 1e-4));
  vec3 tint = pow(clamp(number_or_zero(bsdf.coat_tint), 0.0, 1.0), vec3(1.0 / inside));
  vec3 left = mix(vec3(1.0), tint, share) * (1.0 - share * taken);
  Closure above = reflecting(glossy_light(s, r, lobe, no_lobe()));
  above.radiance += below.radiance * left;
  above.unsplit += below.unsplit * left;
  above.shift += below.shift * left;
  above.transmittance = below.transmittance * left;
  return above;
}
#endif

#ifdef SHEEN
// Fibres on top: they scatter light at the edge, and take what they scatter from below.
Closure sheened(Shading s, Bsdf bsdf, Closure below)
{
  float weight = clamp(number_or_zero(bsdf.sheen), 0.0, 1.0);
  float roughness = clamp(number_or_zero(bsdf.sheen_roughness), 0.0, 1.0);
  vec3 tint = max(number_or_zero(bsdf.sheen_tint), vec3(0.0)) * weight;
  bsdf.shape = Shape(SHAPE_MICROFIBER, vec4(roughness, 0.0, 0.0, 0.0), vec3(0.0));
  bsdf.color = tint;
  Closure above = closure_diffuse(s, bsdf);
  vec3 taken = tint * microfiber_albedo(s.cos_view, roughness);
  below = closure_scaled(below, max(1.0 - max(taken.r, max(taken.g, taken.b)), 0.0));
  return closure_add(below, above);
}
#endif

Closure closure_principled(Shading s, Bsdf bsdf)
{
  // As in Cycles, a base brighter than white is one only where it is diffuse.
  vec3 base = max(number_or_zero(bsdf.color), vec3(0.0));
  float share = clamp(number_or_zero(bsdf.metallic), 0.0, 1.0);
  float r = clamp(number_or_zero(bsdf.roughness), 0.0, 1.0);
  vec3 tint = max(number_or_zero(bsdf.specular_tint), vec3(0.0));
  // At most 1: then all light is reflected.
  float eta = clamp(number_or_zero(bsdf.ior), 1e-5, 1e5);
  float f0 = f0_from_ior(eta);
  float specular_level = number_or_zero(bsdf.specular_level);
  if (specular_level != 0.5) {
    f0 *= 2.0 * max(specular_level, 0.0);
    float raised = ior_from_f0(f0);
    eta = (eta < 1.0) ? 1.0 / raised : raised;
    f0 = f0_from_ior(eta);
  }
  vec3 albedo = ggx_albedo(ggx_tx, s.cos_view, r);
  Lobe metal_lobe = metal(vec3(share), base, tint);
  Lobe dielectric = Lobe(vec3(1.0 - share), clamp(f0 * tint, 0.0, 1.0), eta, true, vec3(0.0));
  Reflected reflected = glossy_light(s, r, metal_lobe, dielectric);
  vec3 through = vec3(0.0);
  if (share < 1.0) {
    // The diffuse layer gets the light that the dielectric layer does not reflect.
    vec3 taken = lobe_albedo(dielectric, albedo, s.cos_view);
    float left = (1.0 - share) * clamp(1.0 - max(taken.r, max(taken.g, taken.b)), 0.0, 1.0);
    float glass = clamp(number_or_zero(bsdf.transmission), 0.0, 1.0);
    Reflected diffuse = diffuse_light(shaped(s, bsdf));
    reflected.light += base * left * (1.0 - glass) * diffuse.light;
    reflected.unsplit += base * left * (1.0 - glass) * diffuse.unsplit;
    reflected.shift += base * left * (1.0 - glass) * diffuse.shift;
#ifdef REFRACTS
    if (glass > 0.0) {
      // Half of the tint at each of two faces.
      through = (1.0 - share) * glass * refracted_light(s, r, eta, sqrt(base), true);
    }
#endif
  }
  Closure closure = with_refracted(reflecting(reflected), through);
#ifdef COATED
  closure = coated(s, bsdf, closure);
#endif
#ifdef SHEEN
  closure = sheened(s, bsdf, closure);
#endif
  closure.radiance += finite_light(bsdf.emission_color * bsdf.emission_strength);
  return closure;
}

// Light from the other side.
Closure closure_translucent(Shading s, Bsdf bsdf)
{
  s.normal = -s.normal;
  return closure_diffuse(s, bsdf);
}

Closure closure_metallic(Shading s, Bsdf bsdf)
{
  float r = clamp(number_or_zero(bsdf.roughness), 0.0, 1.0);
  vec3 color = max(number_or_zero(bsdf.color), vec3(0.0));
  Lobe lobe = metal(vec3(1.0), color, max(number_or_zero(bsdf.specular_tint), vec3(0.0)));
  lobe.repeats = bsdf.repeats;
  return reflecting(glossy_light(s, r, lobe, no_lobe()));
}

// Reflects, and shows what is behind. `specular_level` is 0 for what only refracts.
Closure closure_glass(Shading s, Bsdf bsdf)
{
  float r = clamp(number_or_zero(bsdf.roughness), 0.0, 1.0);
  vec3 color = max(number_or_zero(bsdf.color), vec3(0.0));
  float eta = clamp(number_or_zero(bsdf.ior), 1e-5, 1e5);
  Lobe lobe = Lobe(bsdf.specular_level * color, vec3(f0_from_ior(eta)), eta, bsdf.repeats, vec3(0.0));
  Closure closure = reflecting(glossy_light(s, r, lobe, no_lobe()));
#ifdef REFRACTS
  return with_refracted(closure, refracted_light(s, r, eta, color, bsdf.specular_level > 0.0));
#else
  return closure;
#endif
}

#ifdef FOG
// Light scattered once towards the eye, and what fog itself emits.
Closure closure_fog(Shading s, Bsdf bsdf)
{
  vec3 extinction = max(number_or_zero(bsdf.extinction), vec3(0.0));
  vec3 passed = fog_transmittance(bsdf);
  // Of what starts evenly along the ray, what arrives; all of it in thin air.
  vec3 arriving = mix((1.0 - passed) / max(extinction, vec3(1e-9)),
                      vec3(bsdf.thickness),
                      vec3(lessThan(extinction * bsdf.thickness, vec3(1e-4))));
  Reflected lit = diffuse_light(shaped(s, bsdf));
  vec3 scattered = max(number_or_zero(bsdf.color), vec3(0.0)) * arriving;
  Closure closure = reflecting(
      Reflected(scattered * lit.light, scattered * lit.unsplit, scattered * lit.shift));
  closure.radiance += finite_light(bsdf.emission_color * arriving);
  closure.transmittance = passed;
  return closure;
}
#endif

Closure closure_lit(Bsdf bsdf)
{
  Shading s = surface_shading(bsdf.normal);
  if (bsdf.kind == BSDF_DIFFUSE) {
    return closure_diffuse(s, bsdf);
  }
  if (bsdf.kind == BSDF_GLOSSY) {
    return closure_glossy(s, bsdf);
  }
#ifdef FOG
  if (bsdf.kind == BSDF_FOG) {
    return closure_fog(s, bsdf);
  }
#endif
#ifdef OTHER_CLOSURES
  if (bsdf.kind == BSDF_TRANSLUCENT) {
    return closure_translucent(s, bsdf);
  }
  if (bsdf.kind == BSDF_METALLIC) {
    return closure_metallic(s, bsdf);
  }
  if (bsdf.kind == BSDF_GLASS) {
    return closure_glass(s, bsdf);
  }
#endif
  return closure_principled(s, bsdf);
}

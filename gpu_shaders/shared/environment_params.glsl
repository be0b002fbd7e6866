// The world for background and image-based lighting.
struct EnvironmentParams {
  vec4 rotation_x;      // xyz: rows that turn a world direction into the image's
  vec4 rotation_y;
  vec4 rotation_z;
  vec4 color;           // rgb: multiplies the image, or is the world without one; w: 1 with image
};

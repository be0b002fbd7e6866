// A triangle over the whole target, at the far plane.
void main()
{
  gl_Position = vec4(pos, 1.0, 1.0);
}

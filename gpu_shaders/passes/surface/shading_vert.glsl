// A triangle over the whole target, at the depth of the mark of what is to be shaded.
// Inputs: mark (from 0 to 1).
void main()
{
  gl_Position = vec4(pos, 2.0 * mark - 1.0, 1.0);
}

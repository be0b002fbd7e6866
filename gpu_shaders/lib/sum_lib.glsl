// Sums of numbers from 0 to 1 that are the same in any order: fixed point, 33 bits for the whole.
#ifndef SUM_LIB_GLSL
#define SUM_LIB_GLSL

// Fixed-point value of 1: as fine as a float is at 1; smaller numbers lose what is below that.
#define SUM_ONE 2147483648.0

struct Sum {
  uint low;
  uint high;
};

#define NO_SUM Sum(0u, 0u)

void sum_add(inout Sum sum, float value)
{
  uint before = sum.low;
  sum.low += uint(value * SUM_ONE);
  sum.high += (sum.low < before) ? 1u : 0u;
}

float sum_value(Sum sum)
{
  return (float(sum.high) * 4294967296.0 + float(sum.low)) / SUM_ONE;
}

// The power of two that is not below a number: to divide by it costs no digits.
float power_above(float value)
{
  return ldexp(1.0, int(ceil(log2(max(value, 1e-30)))));
}

#endif

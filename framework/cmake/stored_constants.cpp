// Compiled and run at configure time: does the compiler store a constant object as it is written? GCC 12.2 with AVX-512
// stores {7, 7, 7, 7, 7, 7, 7, 7} in place of the first one unless it may not broadcast from general registers.
#include <cstdio>
#include <cstring>

namespace {

template <class T, int n>
__attribute__((noinline)) void store_halves(T* to) {
  T constant[n] = {};
  for (int i = 0; i < n / 2; ++i) constant[i] = T(7);
  std::memcpy(to, constant, sizeof constant);
}

__attribute__((noinline)) void store_eight(int* to) {
  const int constant[8] = {7, 7, 7, 7, 0, 0, 0, 0};
  std::memcpy(to, constant, sizeof constant);
}

__attribute__((noinline)) void store_doubles(double* to) {
  const double constant[8] = {1.5, 1.5, 0, 0, 1.5, 1.5, 0, 0};
  std::memcpy(to, constant, sizeof constant);
}

__attribute__((noinline)) void store_bytes(unsigned char* to) {
  const unsigned char constant[16] = {3, 3, 3, 3, 3, 3, 3, 3, 0, 0, 0, 0, 0, 0, 0, 0};
  std::memcpy(to, constant, sizeof constant);
}

int wrong = 0;

void expect(const char* what, int at, double stored, double written) {
  if (stored == written) return;
  std::printf("%s: entry %d is written as %g and stored as %g; ", what, at, written, stored);
  ++wrong;
}

template <class T, int n>
void check_halves(const char* what) {
  T stored[n];
  store_halves<T, n>(stored);
  for (int i = 0; i < n; ++i) expect(what, i, static_cast<double>(stored[i]), i < n / 2 ? 7.0 : 0.0);
}

}  // namespace

int main() {
  int eight[8];
  store_eight(eight);
  for (int i = 0; i < 8; ++i) expect("int[8]", i, eight[i], i < 4 ? 7 : 0);
  double doubles[8];
  store_doubles(doubles);
  for (int i = 0; i < 8; ++i) expect("double[8]", i, doubles[i], i % 4 < 2 ? 1.5 : 0.0);
  unsigned char bytes[16];
  store_bytes(bytes);
  for (int i = 0; i < 16; ++i) expect("unsigned char[16]", i, bytes[i], i < 8 ? 3 : 0);
  check_halves<int, 16>("int[16]");
  check_halves<short, 16>("short[16]");
  check_halves<float, 8>("float[8]");
  check_halves<double, 4>("double[4]");
  check_halves<double, 8>("double[8]");
  return wrong == 0 ? 0 : 1;
}

// Prints the errors of Kerf's laws against files of curves: kerf_law_curves [--all] FILE.csv ...
//
// --all prints every column of a file, not only the one that comes nearest to its tolerance.
#include <cstdio>
#include <exception>
#include <string>

#include "support/curves.hpp"

int main(int n_arguments, char** arguments) {
  const bool all_columns = n_arguments > 1 && std::string(arguments[1]) == "--all";
  if (n_arguments < (all_columns ? 3 : 2)) {
    std::fprintf(stderr, "usage: kerf_law_curves [--all] FILE.csv ...\n");
    return 2;
  }
  bool all = true;
  std::printf("%-24s %-44s %-34s %10s %10s %8s\n", "law", "file", "column", "error", "tolerance", "at");
  for (int i = all_columns ? 2 : 1; i < n_arguments; ++i) try {
      all = kerf::test::print_results(arguments[i], all_columns) && all;
    } catch (const std::exception& error) {
      std::printf("%-24s %-44s error: %s\n", "-", arguments[i], error.what());
      all = false;
    }
  return all ? 0 : 1;
}

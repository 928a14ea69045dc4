// Prints the errors of Kerf's laws against files of curves: kerf_law_curves [--all | --markdown] FILE.csv ...
//
// --all prints every column of a file, not only the one that comes nearest to its tolerance; --markdown prints the rows
// of the table in doc/theory/accuracy.md.
#include <cstdio>
#include <exception>
#include <string>

#include "support/curves.hpp"

int main(int n_arguments, char** arguments) {
  using kerf::test::PrintedAs;
  PrintedAs form = PrintedAs::worst_column;
  int first = 1;
  for (; first < n_arguments && std::string(arguments[first]).starts_with("--"); ++first)
    form = std::string(arguments[first]) == "--all" ? PrintedAs::all_columns : PrintedAs::markdown;
  if (first >= n_arguments) {
    std::fprintf(stderr, "usage: kerf_law_curves [--all | --markdown] FILE.csv ...\n");
    return 2;
  }
  bool all = true;
  if (form != PrintedAs::markdown)
    std::printf("%-24s %-44s %-34s %10s %10s %8s\n", "law", "file", "column", "error", "tolerance", "at");
  for (int i = first; i < n_arguments; ++i) try {
      all = kerf::test::print_results(arguments[i], form) && all;
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: error: %s\n", arguments[i], error.what());
      all = false;
    }
  return all ? 0 : 1;
}

// Reads numbers from the text of a CSV file: two columns, or all of them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/diagnostics.hpp"

namespace kerf {

/// Two columns of the same length. `line` and `column` say where the first number of each row stands, from one.
struct CsvColumns {
  std::vector<double> first, second;
  std::vector<int> line, column;
};

/// Reads the two chosen columns, each given by its name in the heading or by its number from one. Fields are separated
/// by commas; empty lines and lines that begin with # are skipped; the first line that is left is the heading if one of
/// its chosen fields is no number. Mistakes go to `diagnostics`, with the place in the file.
CsvColumns read_csv_columns(const std::string& text, const std::string& file, const std::vector<std::string>& chosen,
                            Diagnostics& diagnostics);

/// A table with a heading. Columns that hold anything but numbers are left out of `columns`.
struct CsvTable {
  std::vector<std::string> headings;  // of all columns
  std::map<std::string, std::vector<double>> columns;
  std::size_t n_rows = 0;
};

/// Reads a table whose first line, but for empty lines and lines that begin with #, is the heading. Mistakes go to
/// `diagnostics`, with the place in the file.
CsvTable read_csv_table(const std::string& text, const std::string& file, Diagnostics& diagnostics);

}  // namespace kerf

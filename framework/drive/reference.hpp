// A table that a curve is compared with, while the curve is made.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "drive/drive.hpp"

namespace kerf {

class Reference {
 public:
  /// Reads the file. `where` is the place of the path in the drive file. Throws InputError where the table does not fit
  /// the columns, or its times the path.
  Reference(const ReferenceInput& input, const std::string& folder, const std::string& where,
            const std::vector<DrivenColumn>& columns, double end);

  /// Times of the rows that are compared, ascending [s].
  const std::vector<double>& times() const { return times_; }
  /// Takes note of the values of all columns at a time, if a row of the table has that time.
  void see(double time, const std::vector<double>& row);
  std::vector<DriveCheck> checks() const;

 private:
  /// What is known of a column.
  struct Compared {
    std::string name;
    std::size_t index = 0;  // in a row
    std::vector<double> wanted;
    double greatest = 0.0, most = 0.0, sum_of_squares = 0.0, loose = 0.0;
    std::size_t row = 0, loose_row = 0, n = 0;
  };
  double tolerance_of(const std::string& column) const;

  const ReferenceInput& input_;
  std::string where_;
  double same_time_;  // times that differ by less are one [s]
  std::vector<double> times_;
  std::vector<Compared> columns_;
  std::size_t next_ = 0;
};

}  // namespace kerf

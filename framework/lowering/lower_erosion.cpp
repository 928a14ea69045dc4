// The criteria of *MAT_ADD_EROSION.
#include <fmt/format.h>

#include "lowering/material_parts.hpp"

namespace kerf::lowering {
namespace {

class AddedErosion {
 public:
  AddedErosion(Lowering& low, const Row& row, std::vector<Node>& criteria)
      : low_(low), row_(row), criteria_(criteria) {}

  void read() {
    warn_of_blanks();
    if (is_set("mxpres")) expression("mxpres", fmt::format("pressure >= {}", in_pascal("mxpres")));
    if (is_set("mnpres")) limit("mnpres", "minimum_pressure", "limit", pressure);
    if (is_set("effeps")) effective_strain();
    principal_strains();
    if (is_set("voleps")) volumetric_strain();
    if (is_set("sigp1")) limit("sigp1", "tensile_stress", "limit", pressure);
    if (is_set("sigvm") && positive("sigvm")) expression("sigvm", fmt::format("von_mises >= {}", in_pascal("sigvm")));
    if (is_set("epssh") && positive("epssh")) {
      limit("epssh", "maximum_shear", "limit", number);
      add(criteria_.back(), "measure", scalar("tensor", row_.origin("epssh")));
    }
    if (is_set("sigth") || is_set("impulse")) impulse();
    if (is_set("failtm") && positive("failtm"))
      expression("failtm",
                 fmt::format("time >= {} s", number_text(row_.value("failtm", time) * low_.units.in_si(time))));
  }

 private:
  /// Whether a criterion counts: its field is given, and is not the number that leaves criteria out.
  bool is_set(const char* field) const {
    if (!row_.given(field)) return false;
    const double excluded = row_.given("excl") ? row_.value("excl") : 0.0;
    if (row_.value(field) == excluded) return false;
    const bool means_nothing = row_.value(field) == 0.0 && std::string_view(field) != "mnpres";
    if (means_nothing)
      low_.refuse(row_.origin(field), fmt::format("a limit of 0, which counts since EXCL is {}, fails every element; "
                                                  "expected {} where the criterion is not meant",
                                                  excluded, excluded));
    return !means_nothing;
  }

  /// Where EXCL is not 0, a blank field may be meant as one that is left out, or as a limit of 0.
  void warn_of_blanks() {
    if (!row_.given("excl") || row_.value("excl") == 0.0) return;
    for (const char* field : {"mxpres", "mneps", "effeps", "voleps", "mnpres", "sigp1", "sigvm", "mxeps", "epssh",
                              "sigth", "impulse", "failtm"})
      if (!row_.given(field))
        return low_.warning(row_.origin("excl"),
                            fmt::format("*MAT_ADD_EROSION: EXCL is {}, and blank fields are taken as left out; other "
                                        "programs take them as limits of 0",
                                        row_.value("excl")));
  }

  bool positive(const char* field) {
    if (row_.value(field) > 0.0) return true;
    low_.refuse(row_.origin(field),
                fmt::format("*MAT_ADD_EROSION: a negative limit, {}, is a curve or another measure, "
                            "which is not taken",
                            row_.value(field)));
    return false;
  }

  std::string in_pascal(const char* field) const {
    return number_text(row_.value(field, pressure) * low_.units.in_si(pressure)) + " Pa";
  }

  void expression(const char* field, const std::string& text) { criteria_.push_back(erosion_where(row_, field, text)); }

  void limit(const char* field, const char* type, const char* key, Dimension dimension) {
    criteria_.push_back(typed(type, row_.origin(field)));
    add(criteria_.back(), key, row_.quantity(field, dimension));
  }

  void effective_strain() {
    const bool plastic = row_.value("effeps") < 0.0;
    criteria_.push_back(typed(plastic ? "plastic_strain" : "geometric_strain", row_.origin("effeps")));
    add(criteria_.back(), "limit", row_.quantity("effeps", number, plastic ? -1.0 : 1.0));
  }

  void principal_strains() {
    if (is_set("mxeps") && positive("mxeps")) limit("mxeps", "principal_strain", "maximum", number);
    if (is_set("mneps")) limit("mneps", "principal_strain", "minimum", number);
  }

  void volumetric_strain() {
    const bool expands = row_.value("voleps") > 0.0;
    criteria_.push_back(typed("volumetric_strain", row_.origin("voleps")));
    add(criteria_.back(), expands ? "tension_limit" : "compression_limit",
        row_.quantity("voleps", number, expands ? 1.0 : -1.0));
  }

  void impulse() {
    if (!is_set("sigth") || !is_set("impulse"))
      return low_.error(row_.origin(is_set("sigth") ? "impulse" : "sigth"),
                        "SIGTH and IMPULSE belong together; expected both or neither");
    criteria_.push_back(typed("tuler_butcher", row_.origin("sigth")));
    Node& criterion = criteria_.back();
    add(criterion, "threshold_stress", row_.quantity("sigth", pressure));
    add(criterion, "exponent", scalar("2", row_.origin("impulse")));
    constexpr Dimension stress_squared_times_time{2, -2, -3};
    add(criterion, "limit",
        scalar(
            number_text(row_.value("impulse", stress_squared_times_time) * low_.units.in_si(stress_squared_times_time)),
            row_.origin("impulse")));
  }

  Lowering& low_;
  const Row& row_;
  std::vector<Node>& criteria_;
};

}  // namespace

void added_criteria(Lowering& low, const Row& row, std::vector<Node>& criteria) {
  AddedErosion(low, row, criteria).read();
}

}  // namespace kerf::lowering

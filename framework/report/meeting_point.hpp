// Keeps the ranks together while a plugin works that asks other ranks.
#pragma once

#include <mpi.h>

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace kerf {

/// Thrown out of a collective function of the model where another rank has left the plugin: this rank has to leave
/// it as well.
class LeftBehind : public std::runtime_error {
 public:
  LeftBehind() : std::runtime_error("another rank has stopped") {}
};

/// Sees to it that ranks meet in the same collective function or leave the plugin together: a plugin that throws
/// on one rank must not leave the others waiting.
class MeetingPoint {
 public:
  enum Place : int {
    failed,
    done,
    sums,
    greatest,
    least,
    nearest,
    from_holder,
    reactions,
    contacts,
    mass_in,
    least_by_key,
    sums_by_key,
    bytes_on_root,
    visit_undeformed
  };

  explicit MeetingPoint(MPI_Comm comm) : comm_(comm) {}
  /// Throws LeftBehind where a rank has failed, and std::runtime_error where ranks come to different places.
  /// Collective.
  void come_to(Place place) const;
  /// Sums over all terms of all ranks, list by list; NaN where a term is not finite. Collective.
  std::vector<double> add_up(const std::vector<std::span<const double>>& lists) const;
  /// Greatest and least values of all ranks, entry by entry; NaN counts as nothing. Collective.
  std::vector<double> greatest_of(std::vector<double> values) const;
  std::vector<double> least_of(std::vector<double> values) const;
  /// Runs a piece of a plugin. Returns what went wrong on the lowest rank where anything did, on all ranks; empty
  /// where nothing did. Collective.
  template <class Work>
  std::string run(const Work& work) const {
    std::string failure;
    try {
      work();
      come_to(done);
      return {};
    } catch (const LeftBehind&) {
      return common(failure);
    } catch (const std::exception& e) {
      failure = e.what();
      if (failure.empty()) failure = "an exception without a word";
    } catch (...) {
      failure = "an exception of unknown type";
    }
    leave();
    return common(failure);
  }

 private:
  void leave() const;
  std::string common(const std::string& failure) const;
  MPI_Comm comm_;
  mutable bool parted_ = false;  // all ranks know that they came to different places
};

}  // namespace kerf

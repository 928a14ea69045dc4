// An HDF5 file of all ranks that is complete at every moment of its life.
//
// New rows and a new image of the headers go to places that the present state of the file does not use. When they are
// on the disk, the first 128 bytes are written, in one piece: from then on the file is in its new state. A run that is
// killed leaves the one or the other.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "output/file.hpp"
#include "output/hdf5_image.hpp"

namespace kerf::hdf5 {

/// Collective functions throw OutputError on all ranks. The description of the contents, `root`, has to be the same on
/// all ranks.
class Hdf5File {
 public:
  Hdf5File() = default;
  /// An empty file, to be filled; nothing is in it before the first commit(). Collective.
  static Hdf5File create(MPI_Comm comm, const std::string& path);
  /// Opens a file of Kerf's after a look at the checksums of its beginning and its headers. With `whole` it reads
  /// everything else, too, and compares it with its checksums. Collective.
  static Hdf5File open(MPI_Comm comm, const std::string& path, bool writable, bool whole);

  Group root;

  /// Sets storage aside at the end of the file. Returns its place; the same on all ranks that call it alike.
  std::uint64_t allocate(std::uint64_t n_bytes);
  /// Transfers at a place; not collective. Failures are known to all ranks after the next collective function.
  void write(std::uint64_t place, std::span<const std::byte> bytes) { file_.write_at(place, bytes); }
  void read(std::uint64_t place, std::span<std::byte> bytes) { file_.read_at(place, bytes); }
  void agree() { file_.agree(); }
  /// Makes what was written and described the state of the file. Post: it is on the disk. Collective.
  void commit();
  /// From now on the headers of one state and the next take turns in two places, so that many states do not make the
  /// file grow. Pre: no dataset has chunks, since the index of chunks lies in the headers of earlier states.
  void take_turns() { takes_turns_ = true; }
  /// Drops all storage from the end of what `root` describes on, where that is worth it. Pre: `root` has been
  /// committed. Collective.
  void shorten();
  /// Gives the file, whose present state is committed, another name. Collective.
  void publish(const std::string& path) { file_.publish(path); }
  void close() { file_.close(); }

 private:
  void open_on_root(std::vector<std::byte>& index, bool exact_size);
  void compare_pieces();
  std::uint64_t end_of_contents() const;
  std::uint64_t place_of_image();

  MPI_Comm comm_ = MPI_COMM_NULL;
  SharedFile file_;
  std::uint64_t end_ = 0;  // of all storage that was given out
  bool takes_turns_ = false;
  std::uint64_t turns_[2] = {}, turn_ = 0, turn_size_ = 0;  // places of images that take turns, and their size
};

/// The entries of all datasets of a file of Kerf's, by path ("group/table"), wherever they lie in the file. Without
/// MPI. Throws std::runtime_error where the file cannot be read or is damaged.
std::map<std::string, std::vector<std::byte>> entries_of_file(const std::string& path);

}  // namespace kerf::hdf5

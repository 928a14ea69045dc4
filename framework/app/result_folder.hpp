// The folder that a command writes its results into.
#pragma once

#include <mpi.h>

#include <string>

#include "app/commands.hpp"

namespace kerf {

/// What --output names, or results/NAME with an ending, for an input NAME.yaml.
std::string result_folder(const RunOptions& options, const std::string& ending = "");

/// Makes it where it is not there. Throws InputError, on all ranks, where that or writing into it is not possible.
/// Collective.
void make_result_folder(MPI_Comm comm, const std::string& folder);

/// Keeps other runs out of a folder as long as it lives.
class FolderLock {
 public:
  /// Pre: the folder is there. Throws InputError, on all ranks, where another run works in it. On a file system without
  /// locks nobody is kept out. Collective.
  FolderLock(MPI_Comm comm, const std::string& folder);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  int id_ = -1;  // on rank 0
};

/// Throws InputError where the environment says that this process is one of several ranks, and MPI says that it is
/// alone: each would compute the whole model and write it into the same folder.
void refuse_lone_ranks(MPI_Comm comm);

}  // namespace kerf

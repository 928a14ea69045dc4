// history.h5: rows join the file whole, survive what happens to the run, and are cut back where a run resumes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "output/collective.hpp"
#include "output/columns.hpp"
#include "parallel/shared_folder.hpp"
#include "support/hdf5_reader.hpp"

namespace kerf {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<ColumnTable> tables = {{"nose", "gauge", {{"pressure", "Pa", "of the element"}, {"id", "-", ""}}},
                                         {"rod", "part_history", {{"mass", "kg", "of live elements"}}}};

class Columns : public test::SharedFolder {
 protected:
  void SetUp() override {
    SharedFolder::SetUp();
    path = folder + "/history.h5";
  }

  /// The values of rank 0 count; others pass something else.
  void add(ColumnFile& file, double time) {
    const double mine = rank == 0 ? 1.0 : -1.0;
    file.add_row(0, time, std::vector<double>{mine * 10.0 * time, mine * 7.0});
  }
  std::vector<double> read(const std::string& name) { return read_table<double>(path, name); }

  std::string path;
};

TEST_F(Columns, a_new_file_is_there_at_once_and_empty) {
  ColumnFile file(MPI_COMM_WORLD, path, tables);
  if (rank == 0) {
    EXPECT_EQ(read("nose/time").size(), 0u);
    EXPECT_EQ(read("rod/mass").size(), 0u);
    EXPECT_FALSE(fs::exists(path + ".part"));
  }
  file.close();
}

TEST_F(Columns, rows_of_rank_0_are_in_the_file_after_sync) {
  ColumnFile file(MPI_COMM_WORLD, path, tables);
  for (const double time : {0.0, 1.0, 2.0}) add(file, time);
  file.add_row(1, 0.5, std::vector<double>{3.0});
  file.sync();
  if (rank == 0) {
    EXPECT_THAT(read("nose/time"), ElementsAre(0.0, 1.0, 2.0));
    EXPECT_THAT(read("nose/pressure"), ElementsAre(0.0, 10.0, 20.0));
    EXPECT_THAT(read("nose/id"), ElementsAre(7.0, 7.0, 7.0));
    EXPECT_THAT(read("rod/time"), ElementsAre(0.5));
    EXPECT_THAT(read("rod/mass"), ElementsAre(3.0));
  }
  file.close();
}

// Columns outgrow their blocks, several times.
TEST_F(Columns, every_state_of_a_growing_file_can_be_read) {
  ColumnFile file(MPI_COMM_WORLD, path, tables);
  int n = 0;
  for (const int rows : {1, 63, 64, 65, 129, 1000, 3000}) {
    for (; n < rows; ++n) add(file, n);
    file.sync();
    if (rank == 0) {
      const std::vector<double> times = read("nose/time"), pressure = read("nose/pressure");
      ASSERT_EQ(times.size(), static_cast<std::size_t>(rows));
      for (int i = 0; i < rows; ++i) ASSERT_EQ(times[i], i);
      for (int i = 0; i < rows; ++i) ASSERT_EQ(pressure[i], 10.0 * i);
    }
    MPI_Barrier(MPI_COMM_WORLD);
  }
  file.close();
}

TEST_F(Columns, many_states_do_not_make_the_file_grow) {
  ColumnFile file(MPI_COMM_WORLD, path, tables);
  for (int i = 0; i < 70; ++i) add(file, i);
  file.sync();
  const auto before = rank == 0 ? fs::file_size(path) : 0;
  for (int i = 70; i < 130; ++i) {  // within the room of the blocks
    add(file, i);
    file.sync();
  }
  if (rank == 0) {
    EXPECT_EQ(fs::file_size(path), before);
    EXPECT_EQ(read("nose/time").size(), 130u);
  }
  file.close();
}

TEST_F(Columns, a_resumed_file_keeps_rows_up_to_the_time_and_goes_on) {
  {
    ColumnFile file(MPI_COMM_WORLD, path, tables);
    for (int i = 0; i < 100; ++i) add(file, i);
    file.add_row(1, 80.0, std::vector<double>{3.0});
    file.close();
  }
  ColumnFile file = ColumnFile::resume(MPI_COMM_WORLD, path, tables, 70.0);
  EXPECT_EQ(file.last_time(0), 70.0);
  EXPECT_EQ(file.last_time(1), -1.0);
  if (rank == 0) {
    EXPECT_EQ(read("nose/time").size(), 71u);  // before anything is written over what was cut
  }
  MPI_Barrier(MPI_COMM_WORLD);
  for (int i = 71; i < 300; ++i) add(file, i);
  file.close();
  if (rank == 0) {
    const std::vector<double> times = read("nose/time");
    ASSERT_EQ(times.size(), 300u);
    for (int i = 0; i < 300; ++i) EXPECT_EQ(times[i], i);
    EXPECT_EQ(read("rod/time").size(), 0u);
  }
}

TEST_F(Columns, a_file_with_other_columns_is_not_continued_on_any_rank) {
  {
    ColumnFile file(MPI_COMM_WORLD, path, tables);
    add(file, 1.0);
    file.close();
  }
  std::vector<ColumnTable> renamed = tables, other_unit = tables, fewer = tables, other_words = tables;
  renamed[0].columns[0].name = "stress";
  other_unit[0].columns[0].unit = "MPa";
  fewer.pop_back();
  other_words[0].columns[0].doc = "in other words";
  for (const auto& wanted : {renamed, other_unit, fewer}) {
    try {
      ColumnFile::resume(MPI_COMM_WORLD, path, wanted, 1.0);
      ADD_FAILURE() << "continued";
    } catch (const OutputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("has other columns than the observers of this run fill"));
    }
  }
  EXPECT_EQ(ColumnFile::resume(MPI_COMM_WORLD, path, other_words, 1.0).last_time(0), 1.0);
}

}  // namespace
}  // namespace kerf

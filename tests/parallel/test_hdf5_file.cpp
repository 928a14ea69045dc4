// Files that Kerf writes by itself are HDF5, in every state that they go through, and damage to them is noticed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mpi.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numeric>

#include "output/checksum.hpp"
#include "output/collective.hpp"
#include "output/hdf5_file.hpp"
#include "parallel/shared_folder.hpp"
#include "support/hdf5_reader.hpp"

namespace kerf {
namespace {

namespace fs = std::filesystem;
using hdf5::Dataset;
using hdf5::Hdf5File;

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

TEST(Checksum, has_the_values_of_the_published_definitions) {
  EXPECT_EQ(crc64(bytes_of("123456789")), 0x995DC9BBDF1939FAu);  // CRC-64/XZ
  EXPECT_EQ(crc64(bytes_of("6789"), crc64(bytes_of("12345"))), 0x995DC9BBDF1939FAu);
  // Jenkins gives these for hashlittle() with the initial value 0.
  EXPECT_EQ(lookup3(bytes_of("")), 0xDEADBEEFu);
  EXPECT_EQ(lookup3(bytes_of("Four score and seven years ago")), 0x17770551u);
}

class Hdf5FileTest : public test::SharedFolder {
 protected:
  void SetUp() override {
    SharedFolder::SetUp();
    path = folder + "/file.h5";
  }

  /// Adds chunks of one row of two numbers; the ranks take turns.
  void grow(Hdf5File& file, Dataset& table, std::int64_t rows) {
    for (std::int64_t row = static_cast<std::int64_t>(table.size[0]); row < rows; ++row) {
      table.places.push_back(file.allocate(16));
      const std::int64_t values[2] = {row, -row};
      if (row % n_ranks == rank) file.write(table.places.back(), std::as_bytes(std::span(values)));
    }
    table.size[0] = static_cast<std::uint64_t>(rows);
    file.root.set("rows", rows);
  }

  std::string path;
};

// 64 chunks fill a node of the index, 4096 two levels of it.
TEST_F(Hdf5FileTest, a_table_of_many_chunks_is_readable_in_every_state) {
  Hdf5File file = Hdf5File::create(MPI_COMM_WORLD, path);
  Dataset& table = file.root.groups["group"].datasets["table"];
  table.type = hdf5::type_of<std::int64_t>();
  table.size = {0, 2};
  table.chunk_rows = 1;
  for (const std::int64_t rows : {0, 1, 63, 64, 65, 128, 200, 4095, 4096, 4097, 4200, 9000}) {
    grow(file, table, rows);
    file.commit();
    if (rank == 0) {
      ASSERT_EQ(read_number(path, "/", "rows"), rows);
      const auto values = read_table<std::int64_t>(path, "group/table");
      ASSERT_EQ(values.size(), static_cast<std::size_t>(2 * rows));
      for (std::int64_t row = 0; row < rows; ++row) {
        ASSERT_EQ(values[static_cast<std::size_t>(2 * row)], row);
        ASSERT_EQ(values[static_cast<std::size_t>(2 * row + 1)], -row);
      }
    }
    MPI_Barrier(MPI_COMM_WORLD);
  }
  file.close();
}

// What is not committed does not touch what readers see: the file is the same up to the end of its last state.
TEST_F(Hdf5FileTest, writing_leaves_the_present_state_alone) {
  Hdf5File file = Hdf5File::create(MPI_COMM_WORLD, path);
  Dataset& table = file.root.datasets["table"];
  table.type = hdf5::type_of<std::int64_t>();
  table.size = {0, 2};
  table.chunk_rows = 1;
  grow(file, table, 70);
  file.commit();
  const auto contents = [&] {
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const std::string before = contents();
  MPI_Barrier(MPI_COMM_WORLD);
  grow(file, table, 90);
  file.agree();
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_EQ(contents().substr(0, before.size()), before);
  if (rank == 0) {
    EXPECT_EQ(read_table<std::int64_t>(path, "table").size(), 140u);
  }
}

TEST_F(Hdf5FileTest, a_shortened_file_holds_what_is_left) {
  Hdf5File file = Hdf5File::create(MPI_COMM_WORLD, path);
  Dataset& table = file.root.datasets["table"];
  table.type = hdf5::type_of<std::int64_t>();
  table.size = {0, 2};
  table.chunk_rows = 1;
  grow(file, table, 3000);
  file.commit();
  const auto whole = fs::file_size(path);
  table.size[0] = 70;
  table.places.resize(70);
  table.full_nodes.resize(1);
  file.commit();
  file.shorten();
  grow(file, table, 80);
  file.commit();
  if (rank == 0) {
    EXPECT_LT(fs::file_size(path), whole);
    const auto values = read_table<std::int64_t>(path, "table");
    ASSERT_EQ(values.size(), 160u);
    for (std::size_t row = 0; row < 80; ++row) EXPECT_EQ(values[2 * row], static_cast<std::int64_t>(row));
  }
}

TEST_F(Hdf5FileTest, a_failure_of_one_rank_is_the_failure_of_all) {
  Hdf5File file = Hdf5File::create(MPI_COMM_WORLD, path);
  std::byte nothing[8];
  if (rank == n_ranks - 1) file.read(1 << 20, nothing);
  try {
    file.commit();
    FAIL() << "nobody noticed";
  } catch (const OutputError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("it ends too early"));
  }
}

}  // namespace
}  // namespace kerf

// HDF5 files from strangers: nothing leaves the file, and nothing is believed about sizes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/stat.h>

#include <array>
#include <fstream>

#include "host/io/problem_file.h"
#include "tests/host/input_files.h"
#include "tests/host/io/output_fixtures.h"

namespace scree {
namespace {

namespace fs = std::filesystem;
using test::refusal;
using test::ScratchDirectory;
using testing::AllOf;
using testing::HasSubstr;

/// A local problem whose parts tests replace by calls of HDF5's own.
class ForeignHdf5 : public ::testing::Test {
 protected:
  void SetUp() override {
    StoredProblem stored;
    LocalProblem p;
    p.W = compress(3, 3, {{0, 0, 1}, {1, 1, 1}, {2, 2, 1}});
    p.q = {-1, 0.25, 0};
    p.mu = {0.3};
    stored.form = p;
    stored.guesses = {{.v = {}, .u = {}, .r = {1, 0, 0}, .l = {}}};
    write_problem(path_, stored);
    write_problem(other_, stored);
  }
  /// Removes a link of the file and calls f(file).
  template <class F>
  void replace(const char* link, F f) {
    const hid_t file = H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(file, 0);
    ASSERT_GE(H5Ldelete(file, link, H5P_DEFAULT), 0);
    f(file);
    ASSERT_GE(H5Fclose(file), 0);
  }
  /// A dataset of doubles with the given properties.
  static void put(hid_t file, const char* name, std::vector<hsize_t> size, hid_t properties,
                  bool write) {
    const hid_t space = H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr);
    const hid_t dataset =
        H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    ASSERT_GE(dataset, 0);
    if (write) {
      const std::vector<double> values(size[0], -1);
      ASSERT_GE(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
                0);
    }
    H5Dclose(dataset);
    H5Sclose(space);
  }
  std::string refused() {
    return refusal([&] { read_problem(path_); });
  }

  ScratchDirectory scratch_;
  fs::path path_ = scratch_ / "problem.hdf5";
  fs::path other_ = scratch_ / "secret.hdf5";
};

constexpr const char* q_path = "fclib_local/vectors/q";

TEST_F(ForeignHdf5, AnExternalLinkIsRefusedByNameAtEveryPlaceOfAPath) {
  for (const char* link : {q_path, "fclib_local/vectors", "fclib_local/W", "fclib_local"}) {
    SetUp();
    replace(link, [&](hid_t file) {
      ASSERT_GE(H5Lcreate_external(other_.c_str(), link, file, link, H5P_DEFAULT, H5P_DEFAULT), 0);
    });
    EXPECT_THAT(refused(), AllOf(HasSubstr(path_.string()), HasSubstr("external link"),
                                 HasSubstr("secret.hdf5")))
        << link;
  }
}

TEST_F(ForeignHdf5, ALinkToAPipeDoesNotWait) {
  const fs::path pipe = scratch_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  replace("fclib_local/W", [&](hid_t file) {
    H5Lcreate_external(pipe.c_str(), "W", file, "fclib_local/W", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_THAT(refused(), HasSubstr("external link"));
  EXPECT_THAT(refusal([&] { read_problem(pipe); }), HasSubstr("not a file"));
  EXPECT_FALSE(h5::is_hdf5(pipe));
  EXPECT_THROW(h5::File::open(pipe), h5::Error);
}

TEST_F(ForeignHdf5, SoftLinksStayInTheFile) {
  const auto soft = [&](const char* target) {
    SetUp();
    replace(q_path, [&](hid_t file) {
      H5Lcreate_external(other_.c_str(), q_path, file, "outside", H5P_DEFAULT, H5P_DEFAULT);
      const hid_t values = H5Dopen2(file, "/guesses/1/r", H5P_DEFAULT);
      H5Olink(values, file, "inside", H5P_DEFAULT, H5P_DEFAULT);
      H5Dclose(values);
      ASSERT_GE(H5Lcreate_soft(target, file, q_path, H5P_DEFAULT, H5P_DEFAULT), 0);
    });
    return refused();
  };
  for (const char* target : {"/outside", "/nothing", "/fclib_local/vectors/q"})
    EXPECT_THAT(soft(target), AllOf(HasSubstr("q is a soft link"), HasSubstr("circle"))) << target;
  EXPECT_EQ(soft("/inside"), "no error");
  EXPECT_EQ(std::get<LocalProblem>(read_problem(path_).form).q, std::vector<double>({1, 0, 0}));
}

TEST_F(ForeignHdf5, ExternalStorageIsRefused) {
  replace(q_path, [&](hid_t file) {
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(properties, other_.c_str(), 0, 24);
    put(file, q_path, {3}, properties, false);
    H5Pclose(properties);
  });
  EXPECT_THAT(refused(), AllOf(HasSubstr("vectors/q"), HasSubstr("external storage")));
}

TEST_F(ForeignHdf5, VirtualDatasetsAreRefusedThoseOfThemselvesToo) {
  for (const std::string& source : {other_.string(), path_.string(), std::string(".")}) {
    SetUp();
    replace(q_path, [&](hid_t file) {
      const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
      const hsize_t size = 3;
      const hid_t space = H5Screate_simple(1, &size, nullptr);
      ASSERT_GE(H5Pset_virtual(properties, space, source.c_str(), q_path, space), 0);
      put(file, q_path, {3}, properties, false);
      H5Sclose(space);
      H5Pclose(properties);
    });
    EXPECT_THAT(refused(), AllOf(HasSubstr("vectors/q"), HasSubstr("virtual dataset"))) << source;
  }
}

TEST_F(ForeignHdf5, SizesThatTheFileCannotHoldAreRefusedBeforeMemoryIsTaken) {
  // 8 TB, which any attempt to allocate would fail with another message.
  replace(q_path, [&](hid_t file) { put(file, q_path, {hsize_t{1} << 40}, H5P_DEFAULT, false); });
  EXPECT_THAT(refused(), AllOf(HasSubstr("vectors/q"), HasSubstr("8796093022208 bytes"),
                               HasSubstr("bytes stores 0 of them")));
  SetUp();
  replace(q_path, [&](hid_t file) {
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk = 1000;
    H5Pset_chunk(properties, 1, &chunk);
    H5Pset_deflate(properties, 9);
    put(file, q_path, {1'000'000'000}, properties, false);
    H5Pclose(properties);
  });
  EXPECT_THAT(refused(), AllOf(HasSubstr("vectors/q"), HasSubstr("expand them 1100 times")));
}

TEST_F(ForeignHdf5, CompressedDataThatAreThereAreRead) {
  replace(q_path, [&](hid_t file) {
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk = 3;
    H5Pset_chunk(properties, 1, &chunk);
    H5Pset_deflate(properties, 9);
    put(file, q_path, {3}, properties, true);
    H5Pclose(properties);
  });
  EXPECT_EQ(std::get<LocalProblem>(read_problem(path_).form).q, std::vector<double>(3, -1));
}

TEST_F(ForeignHdf5, OneArrayReadManyTimesIsNotManyTimesTheMemory) {
  const hsize_t rows = 30'000;
  const int guesses = 20;
  replace("guesses", [&](hid_t file) {
    put(file, "big", {rows}, H5P_DEFAULT, true);
    const hid_t all = H5Gcreate2(file, "guesses", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t one = H5Gcreate2(all, "1", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t big = H5Dopen2(file, "big", H5P_DEFAULT);
    H5Olink(big, one, "r", H5P_DEFAULT, H5P_DEFAULT);
    for (int k = 2; k <= guesses; ++k)
      H5Olink(one, all, std::to_string(k).c_str(), H5P_DEFAULT, H5P_DEFAULT);
    const hid_t scalar = H5Screate(H5S_SCALAR);
    const hid_t count = H5Dcreate2(all, "number_of_guesses", H5T_NATIVE_INT, scalar, H5P_DEFAULT,
                                   H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(count, H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, &guesses);
    for (const hid_t id : {count, big}) H5Dclose(id);
    H5Sclose(scalar);
    for (const hid_t id : {one, all}) H5Gclose(id);
  });
  EXPECT_THAT(refused(), HasSubstr("twice over"));
}

}  // namespace
}  // namespace scree

// Images that are written and read back, and files that appear whole or not at all.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "kerf/base/error.h"
#include "kerf/io/image_read.h"
#include "kerf/io/image_write.h"
#include "kerf/io/output_file.h"

// A reader that is not ours, to look into the PNGs.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace kerf {
namespace {

/// A folder of its own for each test, removed at its end.
class Files : public testing::Test {
 protected:
  Files() : folder_(testing::TempDir() + "kerf_image_test." + std::to_string(::getpid())) {
    std::filesystem::create_directory(folder_);
  }
  ~Files() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  size_t count() const {
    const std::filesystem::directory_iterator files(folder_);
    return static_cast<size_t>(std::distance(begin(files), end(files)));
  }
  static std::string content(const std::string& path) {
    std::stringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }
  std::string made(const std::string& text) const {
    std::ofstream(path("made.pfm"), std::ios::binary) << text;
    return path("made.pfm");
  }

 private:
  std::string folder_;
};
using ImageTest = Files;
using OutputFileTest = Files;

template <class F>
std::string error_of(F&& f, ErrorCode code = ErrorCode::file) {
  try {
    f();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    return error.what();
  }
  return "no error";
}

TEST_F(ImageTest, PfmKeepsEveryFloat) {
  for (const uint32_t channels : {1U, 3U}) {
    Image image{5, 3, channels, {}};
    for (uint32_t i = 0; i < 15 * channels; ++i)
      image.pixels.push_back(std::ldexp(static_cast<float>(i) - 7, 3 * static_cast<int>(i)));
    image.pixels[4] = INFINITY;
    write_image(path("image.pfm"), image);
    const Image back = read_pfm(path("image.pfm"));
    EXPECT_EQ(back.width, 5U);
    EXPECT_EQ(back.height, 3U);
    EXPECT_EQ(back.channels, channels);
    EXPECT_EQ(back.pixels, image.pixels);
  }
}

TEST_F(ImageTest, PfmBeginsAtTheBottomAndIsLittleEndian) {
  write_pfm(path("a.pfm"), {1, 2, 1, {1, 2}});
  EXPECT_EQ(content(path("a.pfm")), std::string("Pf\n1 2\n-1.0\n\0\0\0\x40\0\0\x80\x3f", 20));
}

TEST_F(ImageTest, PfmOfEitherByteOrderAndScale) {
  const std::string one("\x3f\x80\0\0", 4), two("\x40\0\0\0", 4);
  EXPECT_EQ(read_pfm(made("Pf\n2 1\n1\n" + one + two)).pixels, (std::vector<float>{1, 2}));
  EXPECT_EQ(read_pfm(made("Pf 1 2 0.5\r\n" + one + two)).pixels, (std::vector<float>{1, 0.5}));
  EXPECT_EQ(read_pfm(made(std::string("Pf\n1 1\n-2\n\0\0\x80\x3f", 14))).pixels, (std::vector<float>{2}));
}

TEST_F(ImageTest, WrongPfmsAreErrorsWithAPlace) {
  const auto what = [&](const std::string& text) { return error_of([&] { read_pfm(made(text)); }); };
  const std::string name = path("made.pfm");
  EXPECT_EQ(what(""), name + ":1: is not a PFM: found '' where it must begin with 'PF' or 'Pf'");
  EXPECT_EQ(what("P6\n1 1\n255\n"), name + ":1: is not a PFM: found 'P6' where it must begin with 'PF' or 'Pf'");
  EXPECT_EQ(what("PF\n1 x\n-1\n"), name + ":2: found 'x' where the height was expected");
  EXPECT_EQ(what("PF\n-1 1\n-1\n"), name + ":2: found '-1' where the width was expected");
  EXPECT_EQ(what("PF\n0 1\n-1\n"), name + ":3: the image has no pixels");
  EXPECT_EQ(what("PF\n1 1\n0\n"), name + ":3: the scale is 0");
  EXPECT_EQ(what("PF\n1 1\nnan\n"), name + ":3: the scale is nan");
  EXPECT_EQ(what("PF\n1 1\n-1\n1234567890"), name + ", byte 20: 10 bytes of pixels; 1 x 1 x 3 floats were expected");
  EXPECT_NE(what("PF\n1 1\n-1\n1234567890123").find("13 bytes of pixels"), std::string::npos);
  EXPECT_NE(what("PF\n4294967295 4294967295\n-1\n1234").find("4 bytes of pixels"), std::string::npos);
  EXPECT_EQ(error_of([&] { read_pfm(path("no.pfm")); }), path("no.pfm") + ": there is no such file");
  write_pfm(path("a.pfm"), {1, 2, 1, {1, 2}});
  const std::string whole = content(path("a.pfm"));
  for (size_t size = 0; size < whole.size(); ++size) EXPECT_NE(what(whole.substr(0, size)), "no error") << size;
}

TEST_F(ImageTest, PngHasRoundedBytesFromTheTop) {
  for (const int channels : {1, 3}) {
    Image image{3, 2, static_cast<uint32_t>(channels), {NAN, -INFINITY, INFINITY, -0.1F, 1.1F, 0.5F}};
    std::vector<int> expected = {0, 0, 255, 0, 255, 128};
    for (int i = 0; channels == 3 && i < 12; ++i) {
      image.pixels.push_back((static_cast<float>(10 * i) + 0.4F) / 255);
      expected.push_back(10 * i);
    }
    write_image(path("image.PNG"), image);
    int width = 0, height = 0, found = 0;
    unsigned char* bytes = stbi_load(path("image.PNG").c_str(), &width, &height, &found, 0);
    ASSERT_NE(bytes, nullptr);
    EXPECT_EQ(width, 3);
    EXPECT_EQ(height, 2);
    EXPECT_EQ(found, channels);
    EXPECT_EQ(std::vector<int>(bytes, bytes + expected.size()), expected);
    stbi_image_free(bytes);
  }
}

TEST_F(ImageTest, ImagesThatCannotBeWrittenLeaveNoFile) {
  const auto what = [&](const std::string& name, const Image& image, ErrorCode code) {
    return error_of([&] { write_image(path(name), image); }, code);
  };
  const Image one{1, 1, 1, {0}};
  EXPECT_TRUE(what("a.jpg", one, ErrorCode::file).starts_with(path("a.jpg") + ": has an unknown image format; .png"));
  EXPECT_NE(what("png", one, ErrorCode::file), "no error");
  for (const char* name : {"a.png", "a.pfm"}) {
    const auto refused = [&](const Image& image) { return what(name, image, ErrorCode::invalid_argument); };
    EXPECT_EQ(refused({1, 1, 2, {0, 0}}), path(name) + ": the image has 2 channels; 1 or 3 can be written");
    EXPECT_EQ(refused({0, 1, 1, {}}), path(name) + ": the image has no pixels (0 x 1)");
    EXPECT_EQ(refused({2, 2, 1, {0, 0}}), path(name) + ": the image has 2 values; 2 x 2 x 1 were expected");
    EXPECT_NE(refused({0x80000000, 0x80000000, 1, {}}), "no error");
  }
  EXPECT_EQ(count(), 0U);
}

TEST_F(OutputFileTest, AppearsAtCommitAndNotBefore) {
  {
    OutputFile file(path("a"));
    file.write("new ");
    EXPECT_FALSE(std::filesystem::exists(path("a")));
    file.write(std::string(200000, 'x'));
    file.write("end");
    file.commit();
  }
  EXPECT_EQ(content(path("a")), "new " + std::string(200000, 'x') + "end");
  {
    OutputFile file(path("a"));
    file.write("lost");
  }
  EXPECT_EQ(content(path("a")).size(), 200007U);
  EXPECT_EQ(count(), 1U);
}

TEST_F(OutputFileTest, KeepsPermissionsAndFollowsLinks) {
  std::ofstream(path("a")) << "old";
  ASSERT_EQ(::chmod(path("a").c_str(), 0640), 0);
  std::filesystem::create_symlink("a", path("link"));
  OutputFile file(path("link"));
  file.write("new");
  file.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(path("link")));
  EXPECT_EQ(content(path("a")), "new");
  struct stat about {};
  ASSERT_EQ(::stat(path("a").c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 07777, 0640U);
}

TEST_F(OutputFileTest, WritersOfOneNameDoNotMix) {
  std::vector<std::thread> writers;
  for (const char letter : {'a', 'b', 'c', 'd'}) {
    writers.emplace_back([this, letter] {
      for (int round = 0; round < 20; ++round) {
        OutputFile file(path("shared"));
        for (int part = 0; part < 10; ++part) file.write(std::string(10000, letter));
        file.commit();
      }
    });
  }
  for (std::thread& writer : writers) writer.join();
  const std::string text = content(path("shared"));
  EXPECT_EQ(text, std::string(100000, text.at(0)));
  EXPECT_EQ(count(), 1U);
}

TEST_F(OutputFileTest, ErrorsNameThePath) {
  const auto what = [](const std::string& target) { return error_of([&] { OutputFile file(target); }); };
  EXPECT_EQ(what(path("no/a")), path("no/a") + ": cannot be written: there is no folder '" + path("no").substr(0, 40) +
                                    (path("no").size() > 40 ? "...'" : "'"));
  std::ofstream(path("file")) << "x";
  EXPECT_NE(what(path("file/a")).find("there is no folder"), std::string::npos);
  EXPECT_EQ(what(path("")), path("") + ": cannot be written: it is a folder");
  EXPECT_EQ(what(testing::TempDir()), testing::TempDir() + ": cannot be written: it is a folder");
  EXPECT_NE(what("").find("cannot be written"), std::string::npos);
}

TEST_F(OutputFileTest, DoesNotReplaceWhatMayNotBeWritten) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const auto what = [](const std::string& target) { return error_of([&] { OutputFile file(target); }); };
  std::ofstream(path("file")) << "x";
  ASSERT_EQ(::chmod(path("file").c_str(), 0444), 0);
  EXPECT_EQ(what(path("file")), path("file") + ": may not be written (permission denied)");
  ASSERT_EQ(::chmod(path("file").c_str(), 0), 0);
  EXPECT_EQ(error_of([&] { read_pfm(path("file")); }), path("file") + ": may not be read (permission denied)");
}

TEST_F(OutputFileTest, AFullDiskIsAnErrorAndLeavesNothing) {
  const auto fill = [](OutputFile& file) {
    for (int i = 0; i < 100; ++i) file.write(std::string(10000, 'x'));
    file.commit();
  };
  OutputFile full("/dev/full");
  EXPECT_EQ(error_of([&] { fill(full); }), "/dev/full: cannot be written: the disk is full");
  EXPECT_EQ(error_of([&] { full.commit(); }), "/dev/full: cannot be written: the disk is full");
  OutputFile small("/dev/full");
  small.write("x");
  EXPECT_EQ(error_of([&] { small.commit(); }), "/dev/full: cannot be written: the disk is full");

  // A limit on the size of files stands for a disk that fills up half-way.
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit limited{100000, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limited), 0);
  std::string what;
  {
    OutputFile file(path("a"));
    what = error_of([&] { fill(file); });
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(what, path("a") + ": cannot be written: File too large");
  EXPECT_EQ(count(), 0U);
}

TEST_F(OutputFileTest, WritesDirectlyWhereNothingCanBeReplaced) {
  OutputFile null("/dev/null");
  null.write("x");
  null.commit();
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));

  const int log = ::open(path("log").c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_EQ(::write(log, "first ", 6), 6);
  {
    OutputFile file("/dev/fd/" + std::to_string(log));
    file.write("second");
    file.commit();
  }
  ::close(log);
  EXPECT_EQ(content(path("log")), "first second");

  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  {
    OutputFile file("/proc/self/fd/" + std::to_string(ends[1]));
    file.write("through");
    file.commit();
  }
  char got[8] = {};
  EXPECT_EQ(::read(ends[0], got, 7), 7);
  EXPECT_STREQ(got, "through");
  ::close(ends[0]);
  ::close(ends[1]);
}

}  // namespace
}  // namespace kerf

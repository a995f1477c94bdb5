#pragma once

#include <string>
#include <string_view>

namespace kerf {

/// A file that appears whole or not at all: it is written under a temporary name in the same folder and takes its own
/// name at commit(). Until then, and after any error, what stood under that name stays. Two that write the same name
/// do not mix; the last commit wins. A link is followed, and the file that it names is replaced, with its permissions
/// kept. What is not a regular file (a pipe, /dev/null) is written directly, /dev/stdout as well.
///
/// Every member throws Error (file) with the path as place: no such folder, not writable, the disk is full.
class OutputFile {
 public:
  explicit OutputFile(std::string path);
  /// Without commit() removes the temporary file.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);

  /// Writes what is left, closes and renames; after an error in write() throws it again. Nothing may be written
  /// afterwards.
  void commit();

 private:
  void open_stream(int stream);
  void open_direct();
  void open_temporary(const std::string& folder);
  void flush();
  void write_through(std::string_view bytes);
  void close();
  [[noreturn]] void fail(int error_number) const;

  std::string path_;       // as the caller gave it, for errors
  std::string target_;     // the file to replace, links resolved
  std::string temporary_;  // empty where writing is direct
  std::string buffer_;
  int descriptor_ = -1;
  int write_error_ = 0;  // of the system, once a write has failed
};

}  // namespace kerf

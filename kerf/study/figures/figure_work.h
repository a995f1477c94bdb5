#pragma once

#include <cstdint>
#include <functional>

namespace kerf {

/// Called now and then from one thread at a time with the share that is done; returns false to stop.
using FigureProgress = std::function<bool(double)>;

/// What all figures of a scene are told.
struct FigureOptions {
  uint32_t width = 480, height = 320;  ///< of each picture in the figure
  int threads = 0;                     ///< of builds and rays; the figure does not depend on it
  bool skip_invalid = false;
  FigureProgress progress;
};

/// Throws the Error (stopped) of a figure whose progress() returned false: there are no unfinished figures.
[[noreturn]] void stop_figure();

/// Calls f(y) for each row of a picture, several at once, with progress. Throws Error (stopped).
void for_each_row(uint32_t height, int threads, const FigureProgress& progress, const std::function<void(uint32_t)>& f);

/// The progress of one of `count` equal parts.
FigureProgress part_of(const FigureProgress& progress, size_t index, size_t count);

}  // namespace kerf

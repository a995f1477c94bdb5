#include "kerf/base/error.h"
#include "kerf/io/image_write.h"

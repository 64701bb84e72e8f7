// The public header as C++17: its types are plain, and its functions have C linkage.
#include "mlim.h"

#include <type_traits>

static_assert(std::is_standard_layout<mlim_mesh>::value && std::is_trivial<mlim_mesh>::value,
  "products are plain data");
static_assert(std::is_trivial<mlim_options>::value && std::is_trivial<mlim_context>::value,
  "options and contexts are plain data");

extern "C" int test_api_cxx();

int test_api_cxx()
{
  mlim_mesh mesh = {};
  mlim_mesh_free(&mesh);
  return mlim_status_text(MLIM_OK) == nullptr;
}

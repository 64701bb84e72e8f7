# The test that fails allocations replaces the allocator: of C through the linker, of C++ by a file.
target_sources(mlim_test_memory PRIVATE "${CMAKE_CURRENT_LIST_DIR}/test_memory_new.cxx")
target_link_options(mlim_test_memory PRIVATE
  "LINKER:--wrap=malloc"
  "LINKER:--wrap=calloc"
  "LINKER:--wrap=realloc")

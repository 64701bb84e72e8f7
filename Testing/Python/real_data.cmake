# Tests of this folder that judge meshes from the outside. Real images are tested when MLIM_DATA
# names their folder: cmake -DMLIM_DATA=/path/to/images.
foreach (name IN ITEMS TestAudit TestExampleData TestLabelMaps TestPictures TestRealData
  TestRealVolumes TestRender TestVolume)
  add_test(NAME python-${name}
    COMMAND "${Python3_EXECUTABLE}" "${CMAKE_CURRENT_LIST_DIR}/${name}.py")
  set_tests_properties(python-${name} PROPERTIES
    LABELS python
    SKIP_RETURN_CODE 77
    ENVIRONMENT "PYTHONPATH=${CMAKE_BINARY_DIR}/${mlim_python_destination};MLIM_DATA=${MLIM_DATA}")
endforeach ()
set_tests_properties(python-TestLabelMaps python-TestRealData python-TestRealVolumes PROPERTIES
  LABELS "python;slow" TIMEOUT 900)
set_tests_properties(python-TestPictures python-TestRender PROPERTIES LABELS "python;image")

# Tests of this folder that judge meshes from the outside. Real images are tested when MLIM_DATA
# names their folder: cmake -DMLIM_DATA=/path/to/images.

# mlim_add_audit(NAME SCRIPT [ARGUMENT...])
function (mlim_add_audit name script)
  add_test(NAME python-${name}
    COMMAND "${Python3_EXECUTABLE}" "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/${script}.py" ${ARGN})
  set_tests_properties(python-${name} PROPERTIES
    LABELS python
    SKIP_RETURN_CODE 77
    ENVIRONMENT "PYTHONPATH=${CMAKE_BINARY_DIR}/${mlim_python_destination};MLIM_DATA=${MLIM_DATA}")
endfunction ()

foreach (name IN ITEMS TestAudit TestExampleData TestPictures TestRealData TestRealVolumes
  TestRender TestVolume)
  mlim_add_audit(${name} ${name})
endforeach ()
# Two at a time are done sooner.
foreach (part IN ITEMS 1 2)
  mlim_add_audit(TestLabelMaps-${part} TestLabelMaps --part=${part}/2)
  set_tests_properties(python-TestLabelMaps-${part} PROPERTIES LABELS "python;slow" TIMEOUT 1200)
endforeach ()
set_tests_properties(python-TestRealData python-TestRealVolumes PROPERTIES
  LABELS "python;slow" TIMEOUT 900)
set_tests_properties(python-TestPictures python-TestRender PROPERTIES LABELS "python;image")

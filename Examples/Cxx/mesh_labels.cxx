// Meshes the interfaces of an image with VTK's own reader and writer, one filter a stage.
//
//   mesh_labels IMAGE.vti SURFACE.vtp [FACET_SIZE]
#include "vtkFieldData.h"
#include "vtkMultiLabelCurveExtractor.h"
#include "vtkMultiLabelCurveProtector.h"
#include "vtkMultiLabelInterfaceMesher.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkXMLImageDataReader.h"
#include "vtkXMLPolyDataWriter.h"

#include <cstdlib>
#include <iostream>

int main(int count, char* words[])
{
  if (count < 3 || count > 4)
  {
    std::cerr << "usage: mesh_labels IMAGE.vti SURFACE.vtp [FACET_SIZE]\n";
    return 2;
  }
  vtkNew<vtkXMLImageDataReader> reader;
  reader->SetFileName(words[1]);

  vtkNew<vtkMultiLabelCurveExtractor> curves;
  curves->SetInputConnection(reader->GetOutputPort());
  vtkNew<vtkMultiLabelCurveProtector> balls;
  balls->SetInputConnection(curves->GetOutputPort());

  // Without the balls the mesher makes them itself, with the same result.
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->SetInputConnection(reader->GetOutputPort());
  mesher->SetBallsConnection(balls->GetOutputPort());
  if (count == 4)
  {
    mesher->SetFacetSize(std::atof(words[3]));
  }

  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputConnection(mesher->GetOutputPort());
  writer->SetFileName(words[2]);
  if (!writer->Write() || mesher->GetOutput()->GetNumberOfPolys() == 0)
  {
    std::cerr << "no mesh\n"; // the reason is in VTK's own message
    return 1;
  }
  vtkFieldData* figures = mesher->GetOutput()->GetFieldData();
  std::cout << mesher->GetOutput()->GetNumberOfPolys() << " triangles, "
            << figures->GetArray("CurveCount")->GetComponent(0, 0) << " curves, "
            << figures->GetArray("LostLabelCount")->GetComponent(0, 0) << " labels lost\n";
  return 0;
}

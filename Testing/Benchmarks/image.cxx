#include "image.h"

#include "vtkMultiLabelInput.h"
#include "vtkMultiLabelRun.h"

#include "vtkAlgorithm.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkVersion.h"
#include "vtkXMLImageDataReader.h"

#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>

namespace
{

struct Owner
{
  vtkSmartPointer<vtkImageData> Image;
  std::unique_ptr<vtkMultiLabel::Input> Input;
};

vtkSmartPointer<vtkImageData> ReadImage(const std::string& path)
{
  vtkNew<vtkXMLImageDataReader> reader;
  if (!reader->CanReadFile(path.c_str()))
  {
    throw std::runtime_error("The file " + path + " is missing or is not an image.");
  }
  reader->SetFileName(path.c_str());
  reader->Update();
  return reader->GetOutput();
}

void Release(void* owner)
{
  delete static_cast<Owner*>(owner);
}

}

int bench_image_read(const char* path, char message[BENCH_MESSAGE_SIZE], bench_image* out)
{
  *out = bench_image();
  try
  {
    auto owner = std::make_unique<Owner>();
    owner->Image = ReadImage(path);
    owner->Input = std::make_unique<vtkMultiLabel::Input>(owner->Image, vtkMultiLabel::Choice());
    if (owner->Input->IsLabelMap())
    {
      vtkNew<vtkAlgorithm> nobody;
      vtkMultiLabel::Run run(nobody, { MLIM_STAGE_INDICATORS });
      owner->Input->MakeIndicators(run);
    }
    out->grid = owner->Input->Grid;
    out->release = &Release;
    out->owner = owner.release();
    return 0;
  }
  catch (const std::exception& error)
  {
    std::snprintf(message, BENCH_MESSAGE_SIZE, "%s", error.what());
    return 1;
  }
}

const char* bench_image_version(void)
{
  return vtkVersion::GetVTKVersion();
}

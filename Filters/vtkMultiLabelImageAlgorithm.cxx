#include "vtkMultiLabelImageAlgorithm.h"

#include "vtkMultiLabelInput.h"

#include "vtkDataArraySelection.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>

vtkMultiLabelImageAlgorithm::vtkMultiLabelImageAlgorithm() = default;

vtkMultiLabelImageAlgorithm::~vtkMultiLabelImageAlgorithm() = default;

void vtkMultiLabelImageAlgorithm::PrintSelf(ostream& os, vtkIndent indent)
{
  const char* const modes[] = { "Array", "Constant", "Complement" };
  this->Superclass::PrintSelf(os, indent);
  os << indent << "PointArraySelection:\n";
  this->PointArraySelection->PrintSelf(os, indent.GetNextIndent());
  os << indent << "BackgroundMode: " << modes[this->BackgroundMode] << "\n";
  os << indent << "BackgroundValue: " << this->BackgroundValue << "\n";
  os << indent << "BackgroundArrayName: " << this->BackgroundArrayName << "\n";
  os << indent << "TieBreaking: " << (this->TieBreaking == Smooth ? "Smooth" : "LowestIndex")
     << "\n";
  os << indent << "UnseenLabels: " << (this->UnseenLabels == Drop ? "Drop" : "Keep") << "\n";
  os << indent << "JunctionMergeTolerance: " << this->JunctionMergeTolerance << "\n";
}

vtkMTimeType vtkMultiLabelImageAlgorithm::GetMTime()
{
  return std::max(this->Superclass::GetMTime(), this->PointArraySelection->GetMTime());
}

int vtkMultiLabelImageAlgorithm::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

int vtkMultiLabelImageAlgorithm::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  for (int port = 0; port < this->GetNumberOfInputPorts(); ++port)
  {
    vtkInformation* info = inputs[port]->GetInformationObject(0);
    if (!info)
    {
      continue;
    }
    info->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
    info->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
    info->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
    if (port == 0 && info->Has(Pipeline::WHOLE_EXTENT()))
    {
      int extent[6];
      info->Get(Pipeline::WHOLE_EXTENT(), extent);
      info->Set(Pipeline::UPDATE_EXTENT(), extent, 6);
    }
  }
  return 1;
}

vtkMultiLabel::Choice vtkMultiLabelImageAlgorithm::GetChoice()
{
  vtkMultiLabel::Choice choice;
  choice.Arrays = this->PointArraySelection;
  choice.BackgroundMode = this->BackgroundMode;
  choice.BackgroundValue = this->BackgroundValue;
  choice.BackgroundArrayName = this->BackgroundArrayName;
  choice.TieBreaking = this->TieBreaking == Smooth ? MLIM_TIE_SMOOTH : MLIM_TIE_LOWEST_INDEX;
  choice.UnseenLabels = this->UnseenLabels == Drop ? MLIM_UNSEEN_DROP : MLIM_UNSEEN_KEEP;
  return choice;
}

void vtkMultiLabelImageAlgorithm::WarnOf(const vtkMultiLabel::Input& input)
{
  for (const std::string& warning : input.Warnings)
  {
    vtkWarningMacro(<< warning);
  }
}

#include "peer.h"

#include <vtkButterflySubdivisionFilter.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

double subdivide_vtk(const soup &coarse, soup *fine)
{
    double start = pel_seconds();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints((vtkIdType)coarse.positions.size() / 3);
    for (size_t v = 0; v < coarse.positions.size() / 3; v++)
        points->SetPoint((vtkIdType)v, &coarse.positions[3 * v]);
    vtkNew<vtkCellArray> cells;
    cells->AllocateExact((vtkIdType)coarse.triangles.size() / 3, (vtkIdType)coarse.triangles.size());
    for (size_t t = 0; t < coarse.triangles.size() / 3; t++) {
        const int *v = &coarse.triangles[3 * t];
        const vtkIdType corners[3] = {v[0], v[1], v[2]};
        cells->InsertNextCell(3, corners);
    }
    vtkNew<vtkPolyData> mesh;
    mesh->SetPoints(points);
    mesh->SetPolys(cells);
    vtkNew<vtkButterflySubdivisionFilter> butterfly;
    butterfly->SetInputData(mesh);
    butterfly->SetNumberOfSubdivisions(1);
    butterfly->Update();
    double time = pel_seconds() - start;
    if (fine == nullptr)
        return time;
    vtkPolyData *out = butterfly->GetOutput();
    for (vtkIdType v = 0; v < out->GetNumberOfPoints(); v++)
        for (int i = 0; i < 3; i++)
            fine->positions.push_back(out->GetPoint(v)[i]);
    vtkIdType count;
    const vtkIdType *corners;
    for (out->GetPolys()->InitTraversal(); out->GetPolys()->GetNextCell(count, corners);)
        for (int i = 0; i < 3; i++)
            fine->triangles.push_back((int)corners[i]);
    return time;
}

#include "page.hpp"

namespace ajar::page {

const std::string_view kPlotScript = R"js(
"use strict";
const D=JSON.parse(document.getElementById("data").textContent),S=D.series,T=D.time,N=T.length;
const $=id=>document.getElementById(id),css=n=>getComputedStyle(document.documentElement).getPropertyValue(n).trim();
const has=k=>S[k]&&S[k].some(v=>v!==null);
const fin=v=>typeof v==="number"&&isFinite(v);
function fmt(v,d=3){if(!fin(v))return"–";const a=Math.abs(v);if(a>=1e5)return v.toExponential(1);return a>=100?v.toFixed(1):a>=10?v.toFixed(Math.min(d,2)):v.toFixed(d)}
function el(tag,text,cls){const e=document.createElement(tag);if(text!==undefined)e.textContent=text;if(cls)e.className=cls;return e}
// Phases as runs of equal names.
const segments=[];
for(let i=0;i<N;i++){const p=D.phase[i];if(!segments.length||segments[segments.length-1].p!==p)segments.push({p,a:i,b:i});segments[segments.length-1].b=i}
const phaseName=i=>D.phase_names[D.phase[i]]||"";
let view=N?[T[0],T[N-1]]:[0,1],cursor=Math.max(0,N-1);
function rangeOf(names){const s=segments.filter(s=>names.includes(D.phase_names[s.p].toLowerCase()));return s.length?[T[s[0].a],T[Math.min(N-1,s[s.length-1].b+1)]]:null}
const openRange=rangeOf(["probe","open"]);
function nearest(t){let a=0,b=N-1;while(b-a>1){const m=(a+b)>>1;if(T[m]<t)a=m;else b=m}return t-T[a]<T[b]-t?a:b}
function ticks(lo,hi,n){const span=hi-lo||1,raw=span/n,mag=Math.pow(10,Math.floor(Math.log10(raw))),step=[1,2,5,10].map(m=>m*mag).find(s=>s>=raw),out=[];
for(let v=Math.ceil(lo/step)*step;v<=hi+1e-9*span;v+=step)out.push(Math.abs(v)<1e-12*span?0:v);return{values:out,digits:Math.max(0,-Math.floor(Math.log10(step)+1e-9))}}
function fit(canvas){const r=window.devicePixelRatio||1,w=Math.max(50,canvas.clientWidth),h=Math.max(50,canvas.clientHeight);canvas.width=w*r;canvas.height=h*r;const g=canvas.getContext("2d");g.setTransform(r,0,0,r,0,0);return{g,w,h}}
const PAD={l:52,r:10,t:16,b:20};
class Plot{
 constructor(def){this.def=def;const box=el("div",undefined,"card plot");box.append(el("h2",def.title+(def.unit?" ["+def.unit+"]":"")));
  this.canvas=el("canvas");this.canvas.setAttribute("role","img");this.canvas.setAttribute("aria-label",def.title);box.append(this.canvas);this.legend=el("div",undefined,"legend");box.append(this.legend);$("plots").append(box);
  this.values=def.series.map(s=>{const item=el("span"),mark=el("i");mark.style.borderTopColor="var("+s.color+")";if(s.dash)mark.className="dash";item.append(mark,s.label+" ");const v=el("b");item.append(v);this.legend.append(item);return v});
  for(const s of def.series)if(s.band){const item=el("span"),mark=el("i",undefined,"box");mark.style.background="var("+s.color+")";item.append(mark,s.bandLabel||"± 2σ");this.legend.append(item)}
  if(def.limits&&def.limits.length){const item=el("span"),mark=el("i",undefined,"dash");mark.style.borderTopColor="var(--bad)";const m=Math.max(...def.limits),n=Math.min(...def.limits);item.append(mark,"limit "+(m===-n?"± "+fmt(m,2):fmt(n,2)+" … "+fmt(m,2))+" "+def.unit);this.legend.append(item)}
  let from=null;const at=e=>{const r=this.canvas.getBoundingClientRect();return this.time(e.clientX-r.left)};
  this.canvas.addEventListener("pointermove",e=>{setCursor(nearest(at(e)));if(from!==null){this.drag=[from,at(e)];this.paint()}});
  this.canvas.addEventListener("pointerdown",e=>{if(e.pointerType==="mouse")from=at(e)});
  window.addEventListener("pointerup",e=>{if(from===null)return;const to=at(e);const a=Math.min(from,to),b=Math.max(from,to);from=null;this.drag=null;if(b-a>(view[1]-view[0])*.01)zoom([a,b]);else this.paint()});
  this.canvas.addEventListener("dblclick",()=>zoom([T[0],T[N-1]]))}
 time(x){return view[0]+(x-PAD.l)/(this.w-PAD.l-PAD.r)*(view[1]-view[0])}
 x(t){return PAD.l+(t-view[0])/(view[1]-view[0]||1)*(this.w-PAD.l-PAD.r)}
 y(v){return this.h-PAD.b-(v-this.lo)/(this.hi-this.lo)*(this.h-PAD.t-PAD.b)}
 range(){let lo=Infinity,hi=-Infinity;for(const s of this.def.series){const d=S[s.key],v=[];for(let i=0;i<N;i++)if(T[i]>=view[0]&&T[i]<=view[1]&&fin(d[i]))v.push(d[i]);if(!v.length)continue;
  v.sort((a,b)=>a-b);const cut=this.def.robust?Math.floor(v.length*.01):0;lo=Math.min(lo,v[cut]);hi=Math.max(hi,v[v.length-1-cut])}
  for(const v of this.def.include||[]){lo=Math.min(lo,v);hi=Math.max(hi,v)}if(!(lo<=hi)){lo=0;hi=1}const pad=(hi-lo||Math.abs(hi)||1)*.08;this.lo=lo-(lo===0&&this.def.floor?0:pad);this.hi=hi+pad}
 draw(){const c=this.base=document.createElement("canvas");this.canvas.style.width="100%";const f=fit(this.canvas);this.w=f.w;this.h=f.h;const r=window.devicePixelRatio||1;c.width=this.canvas.width;c.height=this.canvas.height;
  const g=c.getContext("2d");g.setTransform(r,0,0,r,0,0);this.range();g.font="12px system-ui,sans-serif";this.phases(g);this.axes(g);
  g.save();g.beginPath();g.rect(PAD.l,PAD.t,this.w-PAD.l-PAD.r,this.h-PAD.t-PAD.b);g.clip();
  g.strokeStyle=css("--bad");g.setLineDash([4,4]);g.lineWidth=1;for(const v of this.def.limits||[]){g.beginPath();g.moveTo(PAD.l,this.y(v));g.lineTo(this.w,this.y(v));g.stroke()}g.setLineDash([]);
  for(const s of this.def.series)if(s.band)this.fillBand(g,s);for(const s of this.def.series)this.line(g,s);g.restore();this.paint()}
 phases(g){segments.forEach((s,k)=>{const a=Math.max(PAD.l,this.x(T[s.a])),b=Math.min(this.w-PAD.r,this.x(T[Math.min(N-1,s.b+1)]));if(b<=a)return;
  if(k%2===0){g.fillStyle=css("--band");g.fillRect(a,PAD.t,b-a,this.h-PAD.t-PAD.b)}const name=D.phase_names[s.p];if(g.measureText(name).width<b-a-4){g.fillStyle=css("--soft");g.textAlign="left";g.textBaseline="bottom";g.fillText(name,a+3,PAD.t-1)}})}
 axes(g){g.strokeStyle=css("--line");g.fillStyle=css("--soft");g.lineWidth=1;g.textAlign="right";g.textBaseline="middle";const ty=ticks(this.lo,this.hi,4);
  for(const v of ty.values){const y=this.y(v);g.beginPath();g.moveTo(PAD.l,y);g.lineTo(this.w-PAD.r,y);g.stroke();g.fillText(v.toFixed(Math.min(6,ty.digits)),PAD.l-6,y)}
  g.textAlign="center";g.textBaseline="top";const tx=ticks(view[0],view[1],Math.max(3,Math.floor(this.w/90)));for(const v of tx.values)g.fillText(v.toFixed(tx.digits)+(v===tx.values[tx.values.length-1]?" s":""),this.x(v),this.h-PAD.b+4)}
 fillBand(g,s){const d=S[s.key],w=S[s.band];g.fillStyle=css(s.color);g.globalAlpha=.18;let run=[];const flush=()=>{if(run.length>1){g.beginPath();run.forEach((i,k)=>{const y=this.y(s.bandFromZero?w[i]:d[i]+w[i]);k?g.lineTo(this.x(T[i]),y):g.moveTo(this.x(T[i]),y)});
  for(const i of run.slice().reverse())g.lineTo(this.x(T[i]),this.y(s.bandFromZero?0:d[i]-w[i]));g.closePath();g.fill()}run=[]};
  for(let i=0;i<N;i++)if(fin(d[i])&&fin(w[i]))run.push(i);else flush();flush();g.globalAlpha=1}
 line(g,s){const d=S[s.key];g.strokeStyle=css(s.color);g.lineWidth=s.dash?1.5:1.8;g.setLineDash(s.dash?[6,4]:[]);g.beginPath();let pen=false;for(let i=0;i<N;i++){if(!fin(d[i])){pen=false;continue}const x=this.x(T[i]),y=this.y(d[i]);pen?g.lineTo(x,y):g.moveTo(x,y);pen=true}g.stroke();g.setLineDash([])}
 paint(){if(!this.base)return;const f=this.canvas.getContext("2d");f.save();f.setTransform(1,0,0,1,0,0);f.clearRect(0,0,this.canvas.width,this.canvas.height);f.drawImage(this.base,0,0);f.restore();
  if(this.drag){f.fillStyle=css("--c1");f.globalAlpha=.2;f.fillRect(this.x(this.drag[0]),PAD.t,this.x(this.drag[1])-this.x(this.drag[0]),this.h-PAD.t-PAD.b);f.globalAlpha=1}
  if(N&&T[cursor]>=view[0]&&T[cursor]<=view[1]){const x=this.x(T[cursor]);f.strokeStyle=css("--ink");f.lineWidth=1;f.beginPath();f.moveTo(x,PAD.t);f.lineTo(x,this.h-PAD.b);f.stroke();
   for(const s of this.def.series){const v=S[s.key][cursor];if(fin(v)&&v>=this.lo&&v<=this.hi){f.fillStyle=css(s.color);f.beginPath();f.arc(x,this.y(v),3.2,0,7);f.fill()}}}
  this.def.series.forEach((s,k)=>{const v=S[s.key][cursor];this.values[k].textContent=fmt(v,s.digits===undefined?2:s.digits)+(fin(v)?" "+(s.unit!==undefined?s.unit:this.def.unit||""):"")+(s.band&&fin(S[s.band][cursor])?" (2σ "+fmt(S[s.band][cursor],2)+")":"")})}
}
const slide=D.slide,angle=slide?"m":"°";
const joints=[];for(let i=1;i<=D.joints;i++)joints.push({key:"dq"+i,label:(D.joint_names[i-1]||"q"+i).replace(/_joint$/,"").replace(/_/g," "),color:"--c"+((i-1)%8+1),digits:2});
const plots=[
{title:"Force on the handle, 20 ms mean",unit:"N",include:[0],series:[{key:"normal_true",label:"normal, true",color:"--c1",digits:1},{key:"pull_true",label:"pull, true",color:"--c2",digits:1},{key:"normal_measured",label:"normal, measured",color:"--c7",dash:1,digits:1},{key:"pull_measured",label:"pull, measured",color:"--c5",dash:1,digits:1}]},
{title:"Opening",unit:angle,include:[0],series:[{key:"opening",label:"true",color:"--truth",digits:slide?3:1},{key:"opening_estimated",label:"the robot's belief",color:"--c1",dash:1,digits:slide?3:1}]},
{title:"Error of the believed direction",unit:"°",robust:1,include:[0],floor:1,series:[{key:"direction_error",label:"true error",color:"--c1",band:"direction_2sigma",bandFromZero:1,bandLabel:"0 … 2σ as the robot believes",digits:1}]},
{title:"Curvature",unit:"1/m",robust:1,include:[0],series:[{key:"curvature_estimated",label:"believed",color:"--c1",band:"curvature_2sigma"},{key:"curvature_true",label:"true",color:"--truth",dash:1}]},
{title:"Distance hand – base",unit:"m",series:[{key:"distance",label:"distance",color:"--c3",digits:3}]},
{title:"Heading error of the base",unit:"°",robust:1,include:[0],series:[{key:"heading_error",label:"heading error",color:"--c4",digits:1}]},
{title:"Commanded joint rates",unit:"rad/s",include:[0],limits:D.joint_limits.length?[...new Set(D.joint_limits.flatMap(v=>[v,-v]))]:[],series:joints},
{title:"Base forward speed",unit:"m/s",include:[0],limits:D.base_limits.length?[D.base_limits[0],-D.base_limits[1]]:[],series:[{key:"cmd_v",label:"commanded",color:"--c1",digits:3},{key:"base_v",label:"measured",color:"--c2",dash:1,digits:3}]},
{title:"Base turning rate",unit:"rad/s",include:[0],limits:D.base_limits.length?[D.base_limits[2],-D.base_limits[2]]:[],series:[{key:"cmd_w",label:"commanded",color:"--c1",digits:3},{key:"base_w",label:"measured",color:"--c2",dash:1,digits:3}]},
{title:"Speed along the mechanism",unit:"m/s",include:[0],series:[{key:"wanted_speed",label:"wanted",color:"--c1",digits:3},{key:"true_speed",label:"true",color:"--truth",dash:1,digits:3}]},
{title:"Smallest singular value of the arm, speed factor",unit:"",include:[0],series:[{key:"sigma_min",label:"σ min",color:"--c6",digits:3},{key:"speed_factor",label:"speed factor",color:"--c5",dash:1}]}
].map(d=>({...d,series:d.series.filter(s=>has(s.key))})).filter(d=>d.series.length).map(d=>new Plot(d));
let queued=false;
function setCursor(i){cursor=i;if(queued)return;queued=true;requestAnimationFrame(()=>{queued=false;for(const p of plots)p.paint();drawTop();$("scrub").value=N?T[cursor]:0;$("now").textContent=N?T[cursor].toFixed(2)+" s  "+phaseName(cursor):""})}
function zoom(v){view=v;for(const p of plots)p.draw()}
)js";

}  // namespace ajar::page
